#include "tests/filter/reference/merge.h"

#include <limits>
#include <optional>

namespace becalm::reference {
namespace {

double brightness(const Rgba& c, double exposure) {
  return std::max(luminance(c), 0.0) + 0.1 / exposure;
}

/// Catmull-Rom kernel (Keys with a = -1/2) at a distance from its centre.
double catmull_rom(double distance) {
  const double d = std::abs(distance);
  if (d < 1) return 1.5 * d * d * d - 2.5 * d * d + 1;
  if (d < 2) return -0.5 * d * d * d + 2.5 * d * d - 4 * d + 2;
  return 0;
}

double excess(double measured, double noise, double count, double errors) {
  return std::max(0.0, measured - noise * (1 + errors * std::sqrt(2 / count)));
}

double gain(double sample, double history, double bias) {
  const double total = sample + history + bias;
  return total > 0 ? 1 - sample / total : 1.0;
}

constexpr double kMostFrames = 64;

Estimate blend(const Estimate& sample, const Estimate& history, double alpha, double bias) {
  if (sample.count <= 0 && history.count > 0) return history;
  if (sample.count <= 0) return {sample.color, 0.0, 0.0};
  if (history.count <= 0) return {sample.color, sample.variance, 1.0};
  Estimate out;
  for (int c = 0; c < 4; ++c) out.color[c] = (1 - alpha) * history.color[c] + alpha * sample.color[c];
  out.variance = (1 - alpha) * (1 - alpha) * (history.variance + bias) + alpha * alpha * sample.variance;
  out.count = std::min(kMostFrames, 1 / (alpha * alpha + (1 - alpha) * (1 - alpha) / history.count));
  return out;
}

}  // namespace

Rgba read_sharp(const Grid<Rgba>& taps, double x, double y) {
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  Rgba sum{};
  for (int v = y0 - 1; v <= y0 + 2; ++v) {
    for (int u = x0 - 1; u <= x0 + 2; ++u) {
      const double w = catmull_rom(x - u) * catmull_rom(y - v);
      for (int c = 0; c < 4; ++c) sum[c] += w * taps.clamped(u, v)[c];
    }
  }
  return sum;
}

Grid<Estimate> warp(const Grid<Estimate>& history, const Grid<Vec2>& offset, filter::Resample resample) {
  Grid<Estimate> warped(history.width, history.height);
  Grid<Rgba> taps(history.width, history.height);
  for (std::size_t i = 0; i < taps.data.size(); ++i) taps.data[i] = history.data[i].color;
  for (int y = 0; y < history.height; ++y) {
    for (int x = 0; x < history.width; ++x) {
      const double px = x + offset.at(x, y).x;
      const double py = y + offset.at(x, y).y;
      if (px < -0.5 || py < -0.5 || px > history.width - 0.5 || py > history.height - 0.5) continue;
      const int x0 = static_cast<int>(std::floor(px));
      const int y0 = static_cast<int>(std::floor(py));
      Estimate linear;
      Rgba low;
      Rgba high;
      low.fill(std::numeric_limits<double>::infinity());
      high.fill(-std::numeric_limits<double>::infinity());
      double weight = 0;
      bool holes = false;
      for (int v = y0 - 1; v <= y0 + 2; ++v) {
        for (int u = x0 - 1; u <= x0 + 2; ++u) {
          const Estimate& tap = history.clamped(u, v);
          holes = holes || tap.count <= 0;
          const double w = std::max(0.0, 1 - std::abs(px - u)) * std::max(0.0, 1 - std::abs(py - v));
          if (tap.count <= 0 || !(w > 0)) continue;
          weight += w;
          linear.variance += w * tap.variance;
          linear.count += w * tap.count;
          for (int c = 0; c < 4; ++c) {
            linear.color[c] += w * tap.color[c];
            low[c] = std::min(low[c], tap.color[c]);
            high[c] = std::max(high[c], tap.color[c]);
          }
        }
      }
      if (!(weight > 0.5)) continue;
      Estimate& out = warped.at(x, y);
      out = {linear.color, linear.variance / weight, linear.count / weight};
      for (double& value : out.color) value /= weight;
      if (resample == filter::Resample::bilinear || holes) continue;
      const Rgba sharp = read_sharp(taps, px, py);
      double share = 1;
      for (int c = 0; c < 4; ++c) {
        const double step = sharp[c] - out.color[c];
        const double room = step > 0 ? high[c] - out.color[c] : low[c] - out.color[c];
        if (std::abs(step) > std::abs(room) + 1e-5 * std::abs(out.color[c]))
          share = std::min(share, room / step);
      }
      for (int c = 0; c < 4; ++c) out.color[c] += share * (sharp[c] - out.color[c]);
    }
  }
  return warped;
}

double patch_bias(double mean_square, double square, double noise, double count, bool smoothed) {
  if (!smoothed) return std::max(excess(mean_square, noise / count, 1, 3), excess(square, noise, count, 3));
  const double signal_and_noise = square + noise;
  return signal_and_noise > 0 ? square * std::pow(square / signal_and_noise, 3) : 0.0;
}

double explained_square(const Estimate& sample, const Estimate& history, filter::Smooth smooth,
                        double noisy_variance) {
  if (smooth == filter::Smooth::frames) return 0.0;
  const double sum = sample.variance + history.variance;
  if (smooth == filter::Smooth::none) return sum;
  return noisy_variance > 0 ? sum * noisy_variance / (noisy_variance + 4 * sample.variance) : 0.0;
}

Merged merge_by_variance(const Grid<Estimate>& sample, const Grid<Estimate>& warped, double exposure,
                         const filter::Settings& settings, const Grid<Estimate>& noisy) {
  const int radius = settings.patch_radius;
  const bool smoothed = settings.smooth != filter::Smooth::none;
  Merged merged{Grid<Estimate>(sample.width, sample.height), Grid<double>(sample.width, sample.height)};
  for (int y = 0; y < sample.height; ++y) {
    for (int x = 0; x < sample.width; ++x) {
      std::array<double, 3> mean{};
      double squares = 0, variance_new = 0, variance_history = 0, expected = 0;
      int count = 0;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, sample.height - 1); ++v) {
        for (int u = std::max(x - radius, 0); u <= std::min(x + radius, sample.width - 1); ++u) {
          const Estimate& s = sample.at(u, v);
          const Estimate& h = warped.at(u, v);
          if ((u == x && v == y) || s.count <= 0 || h.count <= 0) continue;
          const double scale = 1 / brightness(h.color, exposure);
          for (int c = 0; c < 3; ++c) {
            const double d = (s.color[c] - h.color[c]) * scale;
            mean[c] += d;
            squares += d * d / 3;
          }
          variance_new += s.variance * scale * scale;
          variance_history += h.variance * scale * scale;
          const double noisy_variance =
              settings.smooth == filter::Smooth::merged ? noisy.at(u, v).variance : 0.0;
          expected += explained_square(s, h, settings.smooth, noisy_variance) * scale * scale;
          ++count;
        }
      }
      double alpha = 1, bias = 0, rejected = 0;
      if (count > 0) {
        variance_new /= count;
        variance_history /= count;
        const double noise = expected / count;
        const Estimate& own = sample.at(x, y);
        const bool counts = own.count > 0 && warped.at(x, y).count > 0;
        const double own_scale = 1 / brightness(warped.at(x, y).color, exposure);
        const double own_variance = counts ? own.variance * own_scale * own_scale : 0.0;
        const double light = std::max(std::abs(luminance(own.color)), 1 / exposure) * own_scale;
        const double borrowed = smoothed ? 0.0 : std::pow(32 * light, 2);
        variance_new = std::min(variance_new, own_variance + borrowed);
        double mean_square = 0;
        for (int c = 0; c < 3; ++c) mean_square += mean[c] * mean[c] / (3.0 * count * count);
        double relative_bias = patch_bias(mean_square, squares / count, noise, count, smoothed);
        if (smoothed && counts && luminance(own.color) < luminance(warped.at(x, y).color)) {
          double own_square = 0;
          for (int c = 0; c < 3; ++c)
            own_square += std::pow((own.color[c] - warped.at(x, y).color[c]) * own_scale, 2) / 3;
          const double own_noise = (own.variance + warped.at(x, y).variance) * own_scale * own_scale;
          if (own_square > 8 * 8 * own_noise) relative_bias = std::max(relative_bias, own_square);
        }
        alpha = std::max(1 / kMostFrames, gain(variance_new, variance_history, relative_bias));
        const double unbiased = gain(variance_new, variance_history, 0);
        const double biased = gain(variance_new, variance_history, relative_bias);
        rejected = variance_new + variance_history > 0 ? 1 - (1 - biased) / (1 - unbiased)
                                                       : (relative_bias > 0 ? 1 : 0);
        const double scale = brightness(warped.at(x, y).color, exposure);
        bias = relative_bias * scale * scale;
      }
      const bool sampled = sample.at(x, y).count > 0;
      const bool held = warped.at(x, y).count > 0;
      merged.estimate.at(x, y) = blend(sample.at(x, y), warped.at(x, y), alpha, bias);
      merged.rejected.at(x, y) = !sampled ? 0.0 : (held ? rejected : 1.0);
    }
  }
  return merged;
}

Grid<Estimate> known_noise(const Grid<Estimate>& noisy, const Grid<Estimate>& warped, double exposure) {
  constexpr int radius = 3;
  struct Noise {
    double seen = 0, told = 0;
  };
  // Nothing where there is no history, or no finite pixel.
  const auto noise_at = [&](int x, int y) -> std::optional<Noise> {
    const Estimate& n = noisy.at(x, y);
    const Estimate& h = warped.at(x, y);
    if (n.count <= 0 || h.count <= 0) return std::nullopt;
    const double scale = 1 / brightness(h.color, exposure);
    Noise noise{.seen = 0, .told = n.variance * scale * scale};
    for (int c = 0; c < 3; ++c) {
      noise.seen += std::pow((n.color[c] - h.color[c]) * scale, 2) / 3 * h.count / (h.count + 1);
    }
    return noise;
  };
  Grid<Estimate> known = noisy;
  for (int y = 0; y < noisy.height; ++y) {
    for (int x = 0; x < noisy.width; ++x) {
      Noise around;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, noisy.height - 1); ++v) {
        for (int u = std::max(x - radius, 0); u <= std::min(x + radius, noisy.width - 1); ++u) {
          const std::optional<Noise> tap = noise_at(u, v);
          if ((u == x && v == y) || !tap) continue;
          around.seen += tap->seen;
          around.told += tap->told;
        }
      }
      const std::optional<Noise> own = noise_at(x, y);
      if (!own || own->seen >= own->told || around.seen >= around.told) continue;
      known.at(x, y).variance *= std::max(around.seen / around.told, own->seen / own->told);
    }
  }
  return known;
}

Merged merge_by_mask(const Grid<Estimate>& sample, const Grid<Estimate>& warped,
                     const Grid<double>& residual) {
  constexpr double kAlpha = 0.9, kKappa = 2.0, kEta = 2.0;
  Merged merged{Grid<Estimate>(sample.width, sample.height), Grid<double>(sample.width, sample.height)};
  for (std::size_t i = 0; i < sample.data.size(); ++i) {
    const Estimate& s = sample.data[i];
    const Estimate& h = warped.data[i];
    const double mask = std::clamp(kKappa * residual.data[i] - kEta, 0.0, 1.0);
    const double n = std::min<double>(h.count, kMostFrames - 1.0);
    const double weight = std::min(kAlpha * (1 - mask), n / (n + 1));
    merged.estimate.data[i] = blend(s, h, 1 - weight, 0);
    merged.rejected.data[i] = s.count <= 0 ? 0.0 : (h.count > 0 ? mask : 1.0);
  }
  return merged;
}

}  // namespace becalm::reference
