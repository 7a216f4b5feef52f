#include "tests/filter/reference/network_shares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/filter/reference/network_layers.h"

namespace becalm::reference {
namespace {

/// A squared difference and what noise alone would make of it, both relative to brightness.
struct Lost {
  double square = 0.0;
  double noise = 0.0;

  double excess() const { return square - noise; }
};

double relative_scale(const Rgba& smoothed, double exposure) {
  return 1.0 / (std::max(luminance(smoothed), 0.0) + 0.1 / exposure);
}

/// What `smoothed` lost of the sample.
Grid<Lost> lost_of(const Grid<Estimate>& sample, const Grid<Estimate>& smoothed, double exposure) {
  Grid<Lost> lost(sample.width, sample.height);
  for (std::size_t i = 0; i < lost.data.size(); ++i) {
    const Rgba& y = smoothed.data[i].color;
    const double scale = relative_scale(y, exposure);
    for (int c = 0; c < 3; ++c)
      lost.data[i].square += std::pow((sample.data[i].color[c] - y[c]) * scale, 2) / 3;
    lost.data[i].noise = sample.data[i].variance * scale * scale;
  }
  return lost;
}

/// Whether the pixel shows a surface, and neither what is far behind all others nor nothing at all.
bool shows_surface(const SmoothFeatures& f) {
  return f[3] < 1.99 && (f[4] != 0 || f[5] != 0 || f[6] != 0);
}

/// Calls `use(u, v)` for the valid pixels of the patch around (x, y), but not for that itself; returns their
/// number.
template <class Use>
int for_neighbours(const Grid<Estimate>& sample, int radius, int x, int y, const Use& use) {
  int count = 0;
  for (int v = std::max(y - radius, 0); v <= std::min(y + radius, sample.height - 1); ++v) {
    for (int u = std::max(x - radius, 0); u <= std::min(x + radius, sample.width - 1); ++u) {
      if ((u == x && v == y) || sample.at(u, v).count <= 0) continue;
      use(u, v);
      ++count;
    }
  }
  return count;
}

/// The share of the sample that a patch of 15x15 calls for, and the patch's mean noise.
struct PatchShare {
  double share = 0.0;
  double mean_noise = 0.0;
};

/// Of pixels that show surfaces, or of those that do not, as the pixel itself.
PatchShare share_of(const Grid<Estimate>& sample, const Grid<Lost>& lost,
                    const Grid<SmoothFeatures>& features, int x, int y) {
  double excess = 0.0, squared_excess = 0.0, mean_noise = 0.0;
  int alike = 0;
  for_neighbours(sample, 7, x, y, [&](int u, int v) {
    if (shows_surface(features.at(u, v)) != shows_surface(features.at(x, y))) return;
    ++alike;
    excess += lost.at(u, v).excess();
    squared_excess += std::pow(lost.at(u, v).excess(), 2);
    mean_noise += lost.at(u, v).noise;
  });
  const double count = std::max(alike, 1);
  mean_noise /= count;
  excess = excess / count - 0.25 * mean_noise;
  const double squared_error = squared_excess / (count * count);
  const double detail = excess > 0 ? excess - 9 * squared_error / excess : 0.0;
  const Lost& own = lost.at(x, y);
  const double noise = std::max(own.noise, mean_noise);
  const double of_pixel = own.square > 16 * 16 * noise ? own.square / (own.square + noise) : 0.0;
  return {std::max(of_pixel, detail > 0 ? detail / (detail + mean_noise) : 0.0), mean_noise};
}

/// Moves `pixel` by `share` to the sample, whose noise has that variance.
void mix(Estimate& pixel, const Rgba& color, double variance, double share) {
  for (int c = 0; c < 4; ++c) pixel.color[c] += share * (color[c] - pixel.color[c]);
  pixel.variance = std::pow(1 - share, 2) * pixel.variance + share * share * variance;
}

}  // namespace

Restored restored(const Grid<Estimate>& sample, const Grid<Estimate>& smoothed,
                  const Grid<SmoothFeatures>& features, double exposure) {
  const Grid<Lost> lost = lost_of(sample, smoothed, exposure);
  Restored out{smoothed, Grid<double>(sample.width, sample.height)};
  for (int y = 0; y < sample.height; ++y) {
    for (int x = 0; x < sample.width; ++x) {
      if (sample.at(x, y).count <= 0) continue;
      const PatchShare patch = share_of(sample, lost, features, x, y);
      mix(out.result.at(x, y), sample.at(x, y).color, sample.at(x, y).variance, patch.share);
      out.patch_noise.at(x, y) = patch.mean_noise;
    }
  }
  return out;
}

Grid<Estimate> with_own_share(const TwoSamples& samples, const Restored& restored,
                              const filter::OwnShareWeights& layers, double exposure) {
  const Grid<Estimate>& merged = restored.result;
  using Measured = std::array<double, 3>;  // squared difference, expected error, variance; all relative
  Grid<Measured> all(merged.width, merged.height);
  for (std::size_t i = 0; i < all.data.size(); ++i) {
    const Rgba& x = samples.own.data[i].color;
    const Rgba& y = merged.data[i].color;
    const double scale = relative_scale(y, exposure);
    double difference = 0;
    for (int c = 0; c < 3; ++c) difference += std::pow((x[c] - y[c]) * scale, 2) / 3;
    all.data[i] = {difference, merged.data[i].variance * scale * scale,
                   std::max(samples.merged.data[i].variance * scale * scale,
                            std::min(0.1 * restored.patch_noise.data[i], 0.05))};
  }
  Grid<Estimate> result = merged;
  for (int y = 0; y < merged.height; ++y) {
    for (int x = 0; x < merged.width; ++x) {
      if (samples.merged.at(x, y).count <= 0) continue;
      Measured patch{};
      const int count = for_neighbours(samples.merged, 3, x, y, [&](int u, int v) {
        for (std::size_t i = 0; i < patch.size(); ++i) patch[i] += all.at(u, v)[i];
      });
      for (double& value : patch) value /= std::max(count, 1);
      const Measured& own = all.at(x, y);
      std::vector<double> values{patch[0], patch[1], patch[2], own[1], own[2]};
      for (double& value : values) value = std::log(std::min(value, 1e6) + 1e-6) / 3;
      for (std::size_t i = 0; i < layers.size(); ++i) {
        values = outputs_of(layers[i], values);
        if (i + 1 == layers.size()) break;
        for (double& value : values) value = std::max(value, 0.0);
      }
      const double limit = std::min(4 * std::min(patch[0], 100.0) / std::max(own[0], 1e-12), 1.0);
      const double share = limit * sigmoid(values[0]);
      Estimate& pixel = result.at(x, y);
      const double scale = relative_scale(pixel.color, exposure);
      pixel.variance = (1 - share) * pixel.variance + share * patch[0] / (scale * scale);
      for (int c = 0; c < 4; ++c) pixel.color[c] += share * (samples.own.at(x, y).color[c] - pixel.color[c]);
    }
  }
  return result;
}

}  // namespace becalm::reference
