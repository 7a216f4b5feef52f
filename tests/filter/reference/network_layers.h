#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "filter/smooth/weights.h"

namespace becalm::reference {

inline std::vector<double> outputs_of(const filter::Layer& layer, const std::vector<double>& features) {
  std::vector<double> out(layer.bias.begin(), layer.bias.end());
  for (int o = 0; o < layer.outputs; ++o) {
    for (int c = 0; c < layer.inputs; ++c) out[o] += layer.at(o, c) * features[c];
  }
  return out;
}

inline double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

}  // namespace becalm::reference
