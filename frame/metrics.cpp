#include "frame/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "frame/compared_pixels.h"
#include "frame/srgb.h"

namespace becalm {
namespace {

/// Keeps relative errors of black pixels finite.
constexpr double kRelativeFloor = 0.01;

/// Sums of K terms over the pixels and channels that are finite in every image; `count` is the number of
/// terms in each sum.
template <std::size_t K>
struct Sums {
  std::array<double, K> total{};
  std::size_t count = 0;
  std::size_t skipped = 0;

  Measured mean() const { return {count > 0 ? total[0] / count : kNothingMeasured, skipped}; }
};

/// `terms(values)` gets the images' values of one channel of one pixel and returns K terms. Rows are summed
/// first, so that the rounding error of large images stays that of a row.
template <std::size_t K, std::size_t N, class Terms>
Sums<K> sum_over(const std::array<const Image*, N>& images, Terms terms) {
  require_comparable(images);
  const int channels = compared_channels(*images[0]);
  Sums<K> sums;
  for (int y = 0; y < images[0]->height(); ++y) {
    std::array<double, K> row{};
    for (int x = 0; x < images[0]->width(); ++x) {
      if (!all_finite(images, x, y, channels)) {
        ++sums.skipped;
        continue;
      }
      for (int c = 0; c < channels; ++c) {
        std::array<double, N> values;
        for (std::size_t i = 0; i < N; ++i) values[i] = images[i]->at(x, y, c);
        const std::array<double, K> term = terms(values);
        for (std::size_t k = 0; k < K; ++k) row[k] += term[k];
      }
      sums.count += channels;
    }
    for (std::size_t k = 0; k < K; ++k) sums.total[k] += row[k];
  }
  return sums;
}

template <std::size_t N, class Term>
Measured mean_over(const std::array<const Image*, N>& images, Term term) {
  return sum_over<1>(images, [&](const auto& values) { return std::array<double, 1>{term(values)}; }).mean();
}

Measured ratio_minus_one(const Sums<2>& sums) {
  if (sums.count == 0) return {kNothingMeasured, sums.skipped};
  if (sums.total[0] == sums.total[1]) return {0.0, sums.skipped};  // also black against black
  return {sums.total[0] / sums.total[1] - 1.0, sums.skipped};
}

/// A product-form error at or below zero means that the test is as good as its references.
Measured decibels(const Measured& squared_error, double peak) {
  if (squared_error.value <= 0.0) return {std::numeric_limits<double>::infinity(), squared_error.skipped};
  return {10.0 * std::log10(peak * peak / squared_error.value), squared_error.skipped};
}

/// Luma of the display image: Rec.709 weights on the encoded channels.
double display_luma(std::span<const float> pixel) {
  if (pixel.size() < 3) return srgb_encoded(pixel[0]);
  return 0.2126 * srgb_encoded(pixel[0]) + 0.7152 * srgb_encoded(pixel[1]) + 0.0722 * srgb_encoded(pixel[2]);
}

constexpr int kSsimRadius = 5;
constexpr int kSsimTaps = 2 * kSsimRadius + 1;

std::array<double, kSsimTaps> ssim_weights() {
  constexpr double sigma = 1.5;
  std::array<double, kSsimTaps> weights;
  double sum = 0.0;
  for (int i = 0; i < kSsimTaps; ++i) {
    const double d = i - kSsimRadius;
    sum += weights[i] = std::exp(-d * d / (2.0 * sigma * sigma));
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Weighted sums over a window's measurable pixels, of 1, x, a, b, x^2, ab and x(a+b)/2, where x is the test
/// and a and b are the references. Independent noise of a and b does not bias these means.
using Moments = std::array<double, 7>;

void add_scaled(Moments& sum, double weight, const Moments& moments) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * moments[k];
}

/// Wang et al. 2004, eq. 13, with dynamic range 1.
double ssim_of(const Moments& m) {
  constexpr double c1 = 0.01 * 0.01;
  constexpr double c2 = 0.03 * 0.03;
  const double mean_x = m[1] / m[0];
  const double mean_a = m[2] / m[0];
  const double mean_b = m[3] / m[0];
  const double mean_y = 0.5 * (mean_a + mean_b);
  const double var_x = m[4] / m[0] - mean_x * mean_x;
  // Not below 0, but for the rounding error that var_x has too: equal images have an SSIM of 1.
  const double var_y = std::max(std::min(0.0, var_x), m[5] / m[0] - mean_a * mean_b);
  const double cov = m[6] / m[0] - mean_x * mean_y;
  return (2.0 * mean_x * mean_y + c1) * (2.0 * cov + c2) /
         ((mean_x * mean_x + mean_y * mean_y + c1) * (var_x + var_y + c2));
}

/// One row of the images as moments, then blurred along the row. Pixels that are not finite have no weight.
class MomentRow {
 public:
  explicit MomentRow(int width) : raw_(width), blurred_(width) {}

  std::size_t fill(const Image& test, const Image& reference_a, const Image& reference_b, int y,
                   const std::array<double, kSsimTaps>& weights) {
    const int width = static_cast<int>(raw_.size());
    const int channels = compared_channels(test);
    std::size_t skipped = 0;
    for (int x = 0; x < width; ++x) {
      raw_[x] = {};
      if (!all_finite(std::array{&test, &reference_a, &reference_b}, x, y, channels)) {
        ++skipped;
        continue;
      }
      const double t = display_luma(test.pixel(x, y).first(channels));
      const double a = display_luma(reference_a.pixel(x, y).first(channels));
      const double b = display_luma(reference_b.pixel(x, y).first(channels));
      raw_[x] = {1.0, t, a, b, t * t, a * b, 0.5 * t * (a + b)};
    }
    for (int x = 0; x < width; ++x) {
      Moments sum{};
      for (int i = std::max(0, kSsimRadius - x); i < std::min(kSsimTaps, width + kSsimRadius - x); ++i) {
        add_scaled(sum, weights[i], raw_[x + i - kSsimRadius]);
      }
      blurred_[x] = sum;
    }
    return skipped;
  }

  bool measurable(int x) const { return raw_[x][0] > 0.0; }
  const Moments& blurred(int x) const { return blurred_[x]; }

 private:
  std::vector<Moments> raw_;
  std::vector<Moments> blurred_;
};

}  // namespace

Measured rel_mse(const Image& test, const Image& reference) {
  return mean_over(std::array{&test, &reference}, [](const auto& v) {
    const auto [x, r] = v;
    return (x - r) * (x - r) / (r * r + kRelativeFloor);
  });
}

Measured rel_mse(const Image& test, const Image& reference_a, const Image& reference_b) {
  return mean_over(std::array{&test, &reference_a, &reference_b}, [](const auto& v) {
    const auto [x, a, b] = v;
    const double r = 0.5 * (a + b);
    return (x - a) * (x - b) / (r * r + kRelativeFloor);
  });
}

Measured temporal_error(const Image& test, const Image& test_before, const Image& reference,
                        const Image& reference_before) {
  return mean_over(std::array{&test, &test_before, &reference, &reference_before}, [](const auto& v) {
    const auto [x, x_before, r, r_before] = v;
    const double error = (x - x_before) - (r - r_before);
    return error * error / (0.5 * (r * r + r_before * r_before) + kRelativeFloor);
  });
}

Measured temporal_error(const Image& test, const Image& test_before, const Image& reference_a,
                        const Image& reference_a_before, const Image& reference_b,
                        const Image& reference_b_before) {
  return mean_over(
      std::array{&test, &test_before, &reference_a, &reference_a_before, &reference_b, &reference_b_before},
      [](const auto& v) {
        const auto [x, x_before, a, a_before, b, b_before] = v;
        const double r = 0.5 * (a + b);
        const double r_before = 0.5 * (a_before + b_before);
        return ((x - x_before) - (a - a_before)) * ((x - x_before) - (b - b_before)) /
               (0.5 * (r * r + r_before * r_before) + kRelativeFloor);
      });
}

Measured energy(const Image& test, const Image& reference) {
  return ratio_minus_one(sum_over<2>(std::array{&test, &reference}, [](const auto& v) { return v; }));
}

Measured energy(const Image& test, const Image& reference_a, const Image& reference_b) {
  return ratio_minus_one(sum_over<2>(std::array{&test, &reference_a, &reference_b}, [](const auto& v) {
    return std::array{v[0], 0.5 * (v[1] + v[2])};
  }));
}

Measured psnr(const Image& test, const Image& reference, double peak) {
  return decibels(
      mean_over(std::array{&test, &reference}, [](const auto& v) { return (v[0] - v[1]) * (v[0] - v[1]); }),
      peak);
}

Measured psnr(const Image& test, const Image& reference_a, const Image& reference_b, double peak) {
  return decibels(mean_over(std::array{&test, &reference_a, &reference_b},
                            [](const auto& v) { return (v[0] - v[1]) * (v[0] - v[2]); }),
                  peak);
}

Measured ssim(const Image& test, const Image& reference) {
  return ssim(test, reference, reference);
}

Measured ssim(const Image& test, const Image& reference_a, const Image& reference_b) {
  require_comparable(std::array{&test, &reference_a, &reference_b});
  const int width = test.width();
  const int height = test.height();
  // Whole windows only, as the paper's published code does. Images smaller than a window use what they have.
  const int margin = std::min(width, height) >= kSsimTaps ? kSsimRadius : 0;
  const std::array<double, kSsimTaps> weights = ssim_weights();

  // A window's rows at a time: row y lies in slot y % kSsimTaps.
  std::vector<MomentRow> rows(kSsimTaps, MomentRow(width));
  Measured result;
  double total = 0.0;
  std::size_t count = 0;
  int filled = 0;
  for (int y = 0; y < height; ++y) {
    for (; filled < std::min(height, y + kSsimRadius + 1); ++filled) {
      result.skipped += rows[filled % kSsimTaps].fill(test, reference_a, reference_b, filled, weights);
    }
    if (y < margin || y >= height - margin) continue;
    double row_total = 0.0;
    for (int x = margin; x < width - margin; ++x) {
      if (!rows[y % kSsimTaps].measurable(x)) continue;
      Moments window{};
      for (int i = std::max(0, kSsimRadius - y); i < std::min(kSsimTaps, height + kSsimRadius - y); ++i) {
        add_scaled(window, weights[i], rows[(y + i - kSsimRadius) % kSsimTaps].blurred(x));
      }
      row_total += ssim_of(window);
      ++count;
    }
    total += row_total;
  }
  result.value = count > 0 ? total / count : kNothingMeasured;
  return result;
}

}  // namespace becalm
