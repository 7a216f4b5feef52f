#pragma once

// What a camera's sensor with a colour filter array sees of a smooth picture.

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "filter/burst/noise_fit.h"
#include "frame/mosaic.h"
#include "tests/filter/reference/burst.h"

namespace becalm::filter::cfa_shots {

inline constexpr NoiseModel kNoise{.a = 2e-4, .b = 1e-6};
inline constexpr std::array<float, 3> kBalance{2.0f, 1.0f, 1.6f};

/// The pattern from another first pixel on.
inline CfaPattern shifted(const CfaPattern& cfa, int x, int y) {
  CfaPattern result = cfa;
  for (int v = 0; v < cfa.period; ++v) {
    for (int u = 0; u < cfa.period; ++u)
      result.colors[v * cfa.period + u] = static_cast<std::uint8_t>(cfa.color(u + x, v + y));
  }
  return result;
}

inline CfaPattern bayer(int phase) {
  return shifted(CfaPattern{}, phase % 2, phase / 2);
}

inline CfaPattern x_trans() {
  CfaPattern cfa{.period = 6, .colors = {}};
  const std::string_view letters = "GRGGBGBGBRGRGRGGBGGBGGRGRGRBGBGBGGRG";
  for (std::size_t i = 0; i < letters.size(); ++i)
    cfa.colors[i] = letters[i] == 'R' ? 0 : letters[i] == 'G' ? 1 : 2;
  return cfa;
}

inline std::vector<CfaPattern> patterns() {
  return {bayer(0), bayer(1), bayer(2), bayer(3), x_trans(), shifted(x_trans(), 1, 2)};
}

/// Light at a point, of one colour: smooth, without a period that the search could mistake.
inline double scene(double x, double y, int color) {
  const double wave = std::sin(0.21 * x + 0.4 * color) * std::sin(0.17 * y - 0.3 * color) +
                      0.6 * std::sin(0.11 * x + 0.13 * y + 0.0007 * x * y) +
                      0.3 * std::sin(0.31 * y - 0.05 * x);
  return (0.3 + 0.13 * wave) / kBalance[color];
}

struct Shot {
  reference::Vec2 shift;
  double noise = 0.0;  ///< times that of kNoise
  unsigned seed = 1;
};

inline Image photographed(const CfaPattern& cfa, int width, int height, const Shot& shot) {
  std::mt19937 random(shot.seed);
  std::normal_distribution<double> normal;
  Image image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double light = scene(x + shot.shift.x, y + shot.shift.y, cfa.color(x, y));
      const double deviation = std::sqrt(kNoise.a * light + kNoise.b);
      image.at(x, y, 0) = static_cast<float>(light + shot.noise * deviation * normal(random));
    }
  }
  return image;
}

}  // namespace becalm::filter::cfa_shots
