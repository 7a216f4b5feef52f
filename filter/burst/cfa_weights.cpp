#include "filter/burst/cfa_weights.h"

#include <Imath/ImathMatrix.h>

#include <cmath>
#include <cstddef>

namespace becalm::filter {
namespace {

/// Weights at the centre of a plane that is fitted to the samples of `color` around pixel (px, py).
std::vector<double> fitted(const CfaPattern& cfa, int px, int py, int color, int reach) {
  const int side = 2 * reach + 1;
  std::vector<double> weights(static_cast<std::size_t>(side) * side, 0.0);
  if (cfa.color(px, py) == color) {
    weights[weights.size() / 2] = 1.0;
    return weights;
  }
  const auto for_each_sample = [&](const auto& use) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        // A multiple of the period keeps the operands of % positive.
        if (cfa.color(px + x + cfa.period, py + y + cfa.period) != color) continue;
        use(x, y, std::exp(-(x * x + y * y) / (0.5 * reach * reach)));
      }
    }
  };
  // Where samples lie on one line its direction alone is known: the ridge keeps the slope across it 0.
  constexpr double ridge = 1e-9;
  Imath::M33d normal(ridge, 0, 0, 0, ridge, 0, 0, 0, ridge);
  for_each_sample([&](int x, int y, double w) {
    const double basis[3] = {1.0, static_cast<double>(x), static_cast<double>(y)};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) normal[i][j] += w * basis[i] * basis[j];
    }
  });
  const Imath::M33d inverse = normal.inverse();
  double sum = 0.0;
  for_each_sample([&](int x, int y, double w) {
    const double weight = w * (inverse[0][0] + inverse[0][1] * x + inverse[0][2] * y);
    weights[static_cast<std::size_t>((y + reach) * side + x + reach)] = weight;
    sum += weight;
  });
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

CfaWeights cfa_weights(const CfaPattern& cfa) {
  CfaWeights weights{.reach = cfa.period == 2 ? 1 : 2, .values = {}};
  for (int y = 0; y < cfa.period; ++y) {
    for (int x = 0; x < cfa.period; ++x) {
      for (int color = 0; color < 3; ++color) {
        const std::vector<double> of_pixel = fitted(cfa, x, y, color, weights.reach);
        weights.values.insert(weights.values.end(), of_pixel.begin(), of_pixel.end());
      }
    }
  }
  return weights;
}

}  // namespace becalm::filter
