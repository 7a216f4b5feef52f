#include "tests/filter/reference/network_shares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/filter/reference/network_layers.h"

namespace becalm::reference {
namespace {

double luminance(const Rgba& c) {
  return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

/// A squared difference and what noise alone would make of it, both relative to brightness.
struct Lost {
  double square = 0.0;
  double noise = 0.0;
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

/// Calls `use(u, v)` for the valid pixels of the 7x7 around (x, y), but not for that itself; returns their
/// number.
template <class Use>
int for_neighbours(const Grid<Estimate>& sample, int x, int y, const Use& use) {
  int count = 0;
  for (int v = std::max(y - 3, 0); v <= std::min(y + 3, sample.height - 1); ++v) {
    for (int u = std::max(x - 3, 0); u <= std::min(x + 3, sample.width - 1); ++u) {
      if ((u == x && v == y) || sample.at(u, v).count <= 0) continue;
      use(u, v);
      ++count;
    }
  }
  return count;
}

Lost mean_of_neighbours(const Grid<Estimate>& sample, const Grid<Lost>& lost, int x, int y) {
  Lost mean;
  const int count = for_neighbours(sample, x, y, [&](int u, int v) {
    mean.square += lost.at(u, v).square;
    mean.noise += lost.at(u, v).noise;
  });
  mean.square /= std::max(count, 1);
  mean.noise /= std::max(count, 1);
  return mean;
}

/// Moves `pixel` by `share` to the sample, whose noise has that variance.
void mix(Estimate& pixel, const Rgba& color, double variance, double share) {
  for (int c = 0; c < 4; ++c) pixel.color[c] += share * (color[c] - pixel.color[c]);
  pixel.variance = std::pow(1 - share, 2) * pixel.variance + share * share * variance;
}

}  // namespace

Grid<Estimate> restored(const Grid<Estimate>& sample, const Grid<Estimate>& smoothed, double exposure) {
  const Grid<Lost> lost = lost_of(sample, smoothed, exposure);
  Grid<Estimate> result = smoothed;
  for (int y = 0; y < sample.height; ++y) {
    for (int x = 0; x < sample.width; ++x) {
      if (sample.at(x, y).count <= 0) continue;
      const Lost mean = mean_of_neighbours(sample, lost, x, y);
      const double count = std::max(for_neighbours(sample, x, y, [](int, int) {}), 1);
      const double detail = mean.square - mean.noise * (1 + 3 * std::sqrt(2 / count));
      const Lost& own = lost.at(x, y);
      const double noise = std::max(own.noise, mean.noise);
      const double of_pixel = own.square > 32 * 32 * noise ? own.square / (own.square + noise) : 0.0;
      const double share = std::max(of_pixel, detail > 0 ? detail / (detail + mean.noise) : 0.0);
      mix(result.at(x, y), sample.at(x, y).color, sample.at(x, y).variance, share);
    }
  }
  return result;
}

Grid<Estimate> with_own_share(const TwoSamples& samples, const Grid<Estimate>& merged,
                              const filter::OwnShareWeights& layers, double exposure) {
  using Measured = std::array<double, 3>;  // squared difference, expected error, variance; all relative
  Grid<Measured> all(merged.width, merged.height);
  for (std::size_t i = 0; i < all.data.size(); ++i) {
    const Rgba& x = samples.own.data[i].color;
    const Rgba& y = merged.data[i].color;
    const double scale = relative_scale(y, exposure);
    double difference = 0;
    for (int c = 0; c < 3; ++c) difference += std::pow((x[c] - y[c]) * scale, 2) / 3;
    all.data[i] = {difference, merged.data[i].variance * scale * scale,
                   samples.merged.data[i].variance * scale * scale};
  }
  Grid<Estimate> result = merged;
  for (int y = 0; y < merged.height; ++y) {
    for (int x = 0; x < merged.width; ++x) {
      if (samples.merged.at(x, y).count <= 0) continue;
      Measured patch{};
      const int count = for_neighbours(samples.merged, x, y, [&](int u, int v) {
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
      const double limit = std::min(4 * patch[0] / std::max(own[0], 1e-12), 1.0);
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
