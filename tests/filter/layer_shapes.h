#pragma once

#include <set>

#include "filter/smooth/weights.h"

namespace becalm {

/// Channels of a 3x3 convolution: of the coarser scale that it reads, of the finer one, and that it writes.
struct LayerShape {
  int coarse = 0;
  int fine = 0;
  int outputs = 0;
  friend auto operator<=>(const LayerShape&, const LayerShape&) = default;
};

/// Those of the embedded networks.
inline std::set<LayerShape> convolution_shapes() {
  std::set<LayerShape> shapes;
  for (const filter::NetworkWeights* network :
       {&filter::embedded_weights(), &filter::embedded_albedo_weights()}) {
    for (const filter::Layer& layer : network->encode) shapes.insert({0, layer.inputs, layer.outputs});
    const filter::Layer of_single = filter::of_single_frame(*network).encode[0];
    shapes.insert({0, of_single.inputs, of_single.outputs});
    for (std::size_t scale = 0; scale < network->decode.size(); ++scale) {
      const filter::Layer& layer = network->decode[scale];
      const int coarse = network->channels[scale + 1];
      shapes.insert({coarse, layer.inputs - coarse, layer.outputs});
    }
    shapes.insert({0, network->finish.inputs, network->finish.outputs});
  }
  return shapes;
}

}  // namespace becalm
