#include "tests/filter/reference/correct.h"

namespace becalm::reference {
namespace {

/// Means over a block, in units of the frame's typical luminance.
struct Block {
  double pixels = 0.0;
  Rgba frame{};
  Rgba estimate{};
  double noise = 0.0;  ///< variance of the frame's mean
};

/// What is left to correct in a block.
struct Difference {
  Rgba value{};
  Rgba relative_to{};
  double noise = 0.0;
};

Block block_mean(const Grid<Estimate>& frame, const Grid<Estimate>& estimate,
                 const Grid<Rgba>& half_difference, bool with_variance, double exposure, int px, int column,
                 int row) {
  Block block;
  Rgba halves{};
  for (int y = row * px; y < std::min((row + 1) * px, frame.height); ++y) {
    for (int x = column * px; x < std::min((column + 1) * px, frame.width); ++x) {
      if (frame.at(x, y).count <= 0 || estimate.at(x, y).count <= 0) continue;
      block.pixels += 1;
      block.noise += frame.at(x, y).variance;
      for (int c = 0; c < 3; ++c) {
        block.frame[c] += frame.at(x, y).color[c];
        block.estimate[c] += estimate.at(x, y).color[c];
        if (!half_difference.data.empty()) halves[c] += half_difference.at(x, y)[c];
      }
    }
  }
  if (block.pixels == 0) return block;
  const double scale = exposure / block.pixels;
  for (int c = 0; c < 3; ++c) {
    block.frame[c] *= scale;
    block.estimate[c] *= scale;
  }
  block.noise *= scale * scale;
  if (!half_difference.data.empty()) {
    double square = 0;
    for (int c = 0; c < 3; ++c) square += halves[c] * scale * halves[c] * scale / 3;
    block.noise = with_variance ? (block.noise + square) / 2 : square;
  }
  return block;
}

/// The coarser level's factors at a block of this level, between the centres of its blocks.
Rgba read_coarser(const Grid<Rgba>& coarser, int x, int y) {
  Rgba factor{};
  for (int c = 0; c < 3; ++c) {
    Grid<double> channel(coarser.width, coarser.height);
    for (std::size_t i = 0; i < channel.data.size(); ++i) channel.data[i] = coarser.data[i][c];
    factor[c] = bilinear(channel, (x + 0.5) / 2 - 0.5, (y + 0.5) / 2 - 0.5);
  }
  return factor;
}

Grid<Rgba> factors(const Grid<Difference>& differences, const Grid<Rgba>& coarser) {
  Grid<Rgba> result(differences.width, differences.height);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      double squares = 0;
      double noise = 0;
      Rgba mean{};
      Rgba base{};
      for (int j = -2; j <= 2; ++j) {
        for (int i = -2; i <= 2; ++i) {
          const Difference& d = differences.clamped(x + i, y + j);
          const double binomial = (2 - std::abs(i)) * (2 - std::abs(j)) / 16.0;  // 0 for the outer ones
          for (int c = 0; c < 3; ++c) {
            squares += d.value[c] * d.value[c] / 3;
            mean[c] += binomial * d.value[c];
            base[c] += binomial * d.relative_to[c];
          }
          noise += d.noise;
        }
      }
      const double signal = std::max(squares - noise, 0.0);
      const double share = signal > 0 ? signal / squares : 0.0;
      result.at(x, y) = read_coarser(coarser, x, y);
      for (int c = 0; c < 3; ++c) {
        const double relative = base[c] > 0 ? mean[c] / base[c] : 0.0;
        result.at(x, y)[c] *= std::clamp(1 + share * relative, 0.5, 2.0);
      }
    }
  }
  return result;
}

}  // namespace

Grid<Rgba> correct(const Grid<Estimate>& frame, const Grid<Estimate>& estimate,
                   const Grid<Rgba>& half_difference, double exposure, int levels, bool with_variance) {
  Grid<Rgba> factor(1, 1, {1, 1, 1, 1});
  for (int level = levels; level >= 0; --level) {
    const int px = 1 << level;
    Grid<Difference> differences((frame.width + px - 1) / px, (frame.height + px - 1) / px);
    for (int y = 0; y < differences.height; ++y) {
      for (int x = 0; x < differences.width; ++x) {
        const Block block = block_mean(frame, estimate, half_difference, with_variance, exposure, px, x, y);
        if (block.pixels == 0) continue;
        const Rgba so_far = read_coarser(factor, x, y);
        Difference& d = differences.at(x, y);
        d.noise = block.noise;
        for (int c = 0; c < 3; ++c) {
          const double corrected = so_far[c] * block.estimate[c];
          d.value[c] = block.frame[c] - corrected;
          d.relative_to[c] = std::max(corrected, 0.0) + 0.01;
        }
      }
    }
    factor = factors(differences, factor);
  }
  Grid<Rgba> corrected(frame.width, frame.height);
  for (std::size_t i = 0; i < corrected.data.size(); ++i) {
    corrected.data[i] = estimate.data[i].color;
    for (int c = 0; c < 3; ++c) corrected.data[i][c] *= factor.data[i][c];
  }
  return corrected;
}

}  // namespace becalm::reference
