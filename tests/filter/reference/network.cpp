#include "tests/filter/reference/network.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/filter/reference/network_layers.h"
#include "tests/filter/reference/network_shares.h"

namespace becalm::reference {
namespace {

using filter::kCoarseTaps;
using filter::kOwnTaps;
using filter::kScales;
using filter::kWindowTaps;
using filter::Layer;

constexpr int kFirstOwn = kWindowTaps + kCoarseTaps;

using Pixel = std::vector<double>;
using Planes = Grid<Pixel>;

struct WindowPixel {
  std::array<double, 3> value{};
  double confidence = 0.0;
  std::array<double, filter::kAffinities> affinities{};
};

double squared_distance(const WindowPixel& a, const WindowPixel& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.affinities.size(); ++i) sum += std::pow(a.affinities[i] - b.affinities[i], 2);
  return sum;
}

Planes convolved(const Planes& in, const Layer& layer) {
  Planes out(in.width, in.height);
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      Pixel& pixel = out.at(x, y);
      pixel.assign(layer.bias.begin(), layer.bias.end());
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          const Pixel& tap = in.clamped(x + i - 1, y + j - 1);
          for (int o = 0; o < layer.outputs; ++o) {
            for (int c = 0; c < layer.inputs; ++c) pixel[o] += layer.at(o, c, j, i) * tap[c];
          }
        }
      }
      for (double& value : pixel) value = std::max(value, 0.0);
    }
  }
  return out;
}

Planes pooled(const Planes& in) {
  Planes out(in.width / 2, in.height / 2);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      Pixel& pixel = out.at(x, y) = in.at(2 * x, 2 * y);
      for (int i = 1; i < 4; ++i) {
        const Pixel& tap = in.at(2 * x + i % 2, 2 * y + i / 2);
        for (std::size_t c = 0; c < pixel.size(); ++c) pixel[c] = std::max(pixel[c], tap[c]);
      }
    }
  }
  return out;
}

/// The coarser scale's channels, each pixel repeated, before those of the finer one.
Planes joined(const Planes& coarse, const Planes& fine) {
  Planes out(fine.width, fine.height);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      Pixel& pixel = out.at(x, y) = coarse.at(x / 2, y / 2);
      const Pixel& own = fine.at(x, y);
      pixel.insert(pixel.end(), own.begin(), own.end());
    }
  }
  return out;
}

double divisor(double albedo) {
  return std::max(albedo, 0.04);
}

/// The frame with its right and lower border repeated until all scales divide its size.
template <class T>
Grid<T> padded(const Grid<T>& grid) {
  const auto up = [](int n) { return (n + 15) / 16 * 16; };
  Grid<T> out(up(grid.width), up(grid.height));
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) out.at(x, y) = grid.clamped(x, y);
  }
  return out;
}

struct Inputs {
  Planes channels;
  Grid<WindowPixel> irradiance;
  Grid<WindowPixel> own_irradiance;
};

double compressed(double v) {
  return 0.5 * std::log(1.0 + 10.0 * std::max(v, 0.0));
}

Inputs inputs_of(const TwoSamples& samples, const TwoFeatures& both, double exposure, bool variance_known) {
  const Grid<Estimate>& sample = samples.merged;
  const Grid<SmoothFeatures>& features = both.merged;
  const int width = sample.width;
  const int height = sample.height;
  Inputs inputs{Planes(width, height), Grid<WindowPixel>(width, height), Grid<WindowPixel>(width, height)};
  Grid<double> grey(width, height);
  Grid<double> own_grey(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      WindowPixel& irradiance = inputs.irradiance.at(x, y);
      WindowPixel& own = inputs.own_irradiance.at(x, y);
      own.confidence = irradiance.confidence = sample.at(x, y).count;
      for (int c = 0; c < 3; ++c) {
        irradiance.value[c] = sample.at(x, y).color[c] * exposure / divisor(features.at(x, y)[c]);
        own.value[c] = samples.own.at(x, y).color[c] * exposure / divisor(both.own.at(x, y)[c]);
        grey.at(x, y) += compressed(irradiance.value[c]) / 3;
        own_grey.at(x, y) += compressed(own.value[c]) / 3;
      }
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      double squares = 0;
      for (int j = -2; j <= 2; ++j) {
        for (int i = -2; i <= 2; ++i) {
          const double d = grey.clamped(x + i, y + j) - grey.at(x, y);
          sum += d / 25;
          squares += d * d / 25;
        }
      }
      const SmoothFeatures& f = features.at(x, y);
      const SmoothFeatures& own = both.own.at(x, y);
      const std::array<double, 3>& v = inputs.irradiance.at(x, y).value;
      double noise = -1.0;
      if (variance_known) {
        double of_divisor = 0;
        for (int c = 0; c < 3; ++c) of_divisor += std::pow(divisor(f[c]), 2) / 3;
        const double deviation = std::sqrt(sample.at(x, y).variance / of_divisor) * exposure;
        const double light = 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
        noise = std::min(std::log(1.0 + deviation / (std::max(light, 0.0) + 0.1)), 10.0);
      }
      inputs.channels.at(x, y) = {compressed(v[0]),
                                  compressed(v[1]),
                                  compressed(v[2]),
                                  f[0],
                                  f[1],
                                  f[2],
                                  f[4],
                                  f[5],
                                  f[6],
                                  f[3],
                                  noise,
                                  std::sqrt(std::max(squares - sum * sum, 0.0)),
                                  own[0],
                                  own[1],
                                  own[2],
                                  own[4],
                                  own[5],
                                  own[6],
                                  own[3],
                                  own_grey.at(x, y)};
    }
  }
  return inputs;
}

std::array<Planes, kScales> features_of(const Planes& inputs, const filter::NetworkWeights& weights) {
  std::array<Planes, kScales> f;
  for (std::size_t i = 0; i < kScales; ++i) {
    f[i] = convolved(i == 0 ? inputs : pooled(f[i - 1]), weights.encode[i]);
  }
  for (std::size_t i = kScales - 1; i-- > 0;) f[i] = convolved(joined(f[i + 1], f[i]), weights.decode[i]);
  f[0] = convolved(f[0], weights.finish);
  return f;
}

Grid<WindowPixel> reduced(const Grid<WindowPixel>& fine) {
  Grid<WindowPixel> out(fine.width / 2, fine.height / 2);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      WindowPixel& pixel = out.at(x, y);
      for (int i = 0; i < 4; ++i) {
        const WindowPixel& tap = fine.at(2 * x + i % 2, 2 * y + i / 2);
        for (int c = 0; c < 3; ++c) pixel.value[c] += tap.confidence * tap.value[c];
        pixel.confidence += tap.confidence;
      }
      for (double& v : pixel.value) v /= pixel.confidence;
      pixel.confidence /= 4;
    }
  }
  return out;
}

/// One scale's result. `coarse` is the coarser scale's result and `own` the unmerged frame, or null.
Grid<WindowPixel> mixed(const Grid<WindowPixel>& pixels, const Planes& features, const Layer& window,
                        const Grid<WindowPixel>* coarse, const Grid<WindowPixel>* own) {
  Grid<WindowPixel> out(pixels.width, pixels.height);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      std::vector<double> logits = outputs_of(window, features.at(x, y));
      for (int t = 0; t < kWindowTaps; ++t) {
        logits[t] -= squared_distance(pixels.clamped(x + t % 5 - 2, y + t / 5 - 2), pixels.at(x, y));
      }
      for (int t = 0; own && t < kOwnTaps; ++t) {
        logits[kFirstOwn + t] -=
            squared_distance(pixels.clamped(x + t % 3 - 1, y + t / 3 - 1), pixels.at(x, y));
      }
      const double largest = *std::ranges::max_element(logits);
      WindowPixel& pixel = out.at(x, y);
      double total = 0;
      const auto add = [&](const WindowPixel& tap, double weight) {
        for (int c = 0; c < 3; ++c) pixel.value[c] += weight * tap.value[c];
        total += weight;
      };
      for (int t = 0; t < kWindowTaps; ++t) {
        const WindowPixel& tap = pixels.clamped(x + t % 5 - 2, y + t / 5 - 2);
        add(tap, std::exp(logits[t] - largest) * tap.confidence);
      }
      for (int t = 0; coarse && t < kCoarseTaps; ++t) {
        const int u = x / 2 + (t % 2 == 0 ? 0 : 2 * (x % 2) - 1);
        const int v = y / 2 + (t / 2 == 0 ? 0 : 2 * (y % 2) - 1);
        add(coarse->clamped(u, v), std::exp(logits[kWindowTaps + t] - largest));
      }
      for (int t = 0; own && t < kOwnTaps; ++t) {
        const WindowPixel& tap = own->clamped(x + t % 3 - 1, y + t / 3 - 1);
        add(tap, std::exp(logits[kFirstOwn + t] - largest) * tap.confidence);
      }
      for (double& v : pixel.value) v /= std::max(total, 1e-30);
    }
  }
  return out;
}

}  // namespace

Grid<Estimate> windows_of_network(const TwoSamples& samples, const TwoFeatures& features, double exposure,
                                  const filter::NetworkWeights& weights, bool variance_known) {
  const Grid<Estimate>& sample = samples.merged;
  const Grid<SmoothFeatures> merged = padded(features.merged);
  const Grid<SmoothFeatures> own = padded(features.own);
  const Grid<Estimate> merged_sample = padded(sample);
  const Grid<Estimate> own_sample = padded(samples.own);
  Inputs inputs = inputs_of({merged_sample, own_sample}, {merged, own}, exposure, variance_known);
  const std::array<Planes, kScales> f = features_of(inputs.channels, weights);
  std::array<Grid<WindowPixel>, kScales> pixels;
  for (std::size_t i = 0; i < kScales; ++i) {
    pixels[i] = i == 0 ? inputs.irradiance : reduced(pixels[i - 1]);
    for (int y = 0; y < pixels[i].height; ++y) {
      for (int x = 0; x < pixels[i].width; ++x) {
        const std::vector<double> head = outputs_of(weights.confidence[i], f[i].at(x, y));
        const double of_scale = std::max(sigmoid(head[0]), 1e-8);
        std::copy_n(head.begin() + 1, filter::kAffinities, pixels[i].at(x, y).affinities.begin());
        double& confidence = pixels[i].at(x, y).confidence;
        if (i == 0) {
          double& own_confidence = inputs.own_irradiance.at(x, y).confidence;
          own_confidence = confidence > 0 ? std::max(sigmoid(head.back()), 1e-8) : 1e-20;
          confidence = confidence > 0 ? of_scale : 1e-20;
        } else {
          confidence *= of_scale;
        }
      }
    }
  }
  Grid<WindowPixel> result;
  for (std::size_t i = kScales; i-- > 0;) {
    result = mixed(pixels[i], f[i], weights.window[i], i + 1 < kScales ? &result : nullptr,
                   i == 0 ? &inputs.own_irradiance : nullptr);
  }

  Grid<Estimate> smoothed(sample.width, sample.height);
  for (int y = 0; y < sample.height; ++y) {
    for (int x = 0; x < sample.width; ++x) {
      Estimate& pixel = smoothed.at(x, y) = sample.at(x, y);
      if (pixel.count <= 0) continue;
      const std::vector<double> logits = outputs_of(weights.albedo, f[0].at(x, y));
      std::array<double, 3> exposed{};
      double total = 0;
      for (int t = 0; t < kWindowTaps; ++t) {
        const double distance =
            squared_distance(pixels[0].clamped(x + t % 5 - 2, y + t / 5 - 2), pixels[0].at(x, y));
        const double weight = std::exp(logits[t] - distance);
        const double own_weight = std::exp(logits[kWindowTaps + t] - distance);
        for (int c = 0; c < 3; ++c) {
          exposed[c] += weight * divisor(features.merged.clamped(x + t % 5 - 2, y + t / 5 - 2)[c]);
          exposed[c] += own_weight * divisor(features.own.clamped(x + t % 5 - 2, y + t / 5 - 2)[c]);
        }
        total += weight + own_weight;
      }
      double square = 0;
      for (int c = 0; c < 3; ++c) {
        exposed[c] *= result.at(x, y).value[c] / total;
        square += exposed[c] * exposed[c] / 3;
        pixel.color[c] = exposed[c] / exposure;
      }
      const double log_error = std::clamp(outputs_of(weights.error, f[0].at(x, y))[0], -12.0, 8.0);
      pixel.variance =
          square == 0 ? 0.0 : std::exp(log_error) * (square + 0.01 / 0.09) / (exposure * exposure);
    }
  }
  return smoothed;
}

Grid<Estimate> smooth_by_network(const TwoSamples& samples, const TwoFeatures& features, double exposure,
                                 const filter::NetworkWeights& weights, bool variance_known,
                                 const filter::OwnShareWeights* own_share) {
  const Grid<Estimate> windows = windows_of_network(samples, features, exposure, weights, variance_known);
  const Restored merged = restored(samples.merged, windows, features.own, exposure);
  if (!own_share) return merged.result;
  return with_own_share(samples, merged, *own_share, exposure);
}

}  // namespace becalm::reference
