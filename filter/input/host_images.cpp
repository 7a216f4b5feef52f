#include "filter/input/host_images.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "filter/for_rows.h"
#include "filter/input/exponents.h"
#include "filter/luminance.h"
#include "shaders/shared/limits.h"

namespace becalm::filter {
namespace {

/// Exposures are clamped to [1/this, this]; beyond it, squares of scaled values leave the range of floats.
constexpr double kLargestExposure = 1e15;
/// Depths from this on mean that nothing was hit: Blender writes 1e10 there, Arnold 1e30.
constexpr float kNothingHit = 1e9f;

/// Calls `use(index in the image, index in the rectangle)` for each pixel of the rectangle, on all threads.
template <class Use>
void for_each_pixel(const Rect& rect, int image_width, const Use& use) {
  for_rows(rect.height, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      std::size_t in_rect = static_cast<std::size_t>(y) * rect.width;
      std::size_t in_image = (static_cast<std::size_t>(rect.y) + y) * image_width + rect.x;
      for (int x = 0; x < rect.width; ++x) use(in_image++, in_rect++);
    }
  });
}

/// Luminances so many times the largest usual one count as that: a firefly of 1e12 would hide all others.
constexpr double kFirefly = 0x1p20;

/// A sum of logarithms and the number of its terms.
struct LogarithmSum {
  LogarithmSum& operator+=(const LogarithmSum& other) {
    exponents += other.exponents;
    mantissas += other.mantissas + std::log2(other.product);
    count += other.count;
    return *this;
  }
  /// Adds log2 of a positive value. Exponents and mantissas are summed separately, so that values scaled by a
  /// power of two have exactly the scaled geometric mean.
  void add(double value) {
    int exponent = 0;
    product *= std::frexp(value, &exponent);
    exponents += exponent;
    ++count;
    if (product > 0x1p-900) return;
    mantissas += std::log2(product);
    product = 1.0;
  }
  double geometric_mean() const {
    std::int64_t whole = exponents / count;
    if (whole * count > exponents) --whole;  // rounds down
    const double rest =
        (static_cast<double>(exponents - whole * count) + mantissas) / static_cast<double>(count);
    return std::ldexp(std::exp2(rest), static_cast<int>(whole));
  }

  std::int64_t exponents = 0;
  double mantissas = 0.0;
  double product = 1.0;  ///< of mantissas that are not in `mantissas` yet
  std::int64_t count = 0;
};

bool all_finite(std::span<const float> values) {
  return std::ranges::all_of(values, [](float v) { return std::isfinite(v); });
}

/// Also false for NaN.
bool is_within(std::span<const float> values, float limit) {
  return std::ranges::all_of(values, [&](float value) { return std::abs(value) <= limit; });
}

/// The mean of three values. It does not overflow where their sum would; a power of two scales them without
/// rounding.
float mean_of_channels(std::span<const float> values) {
  constexpr float scale = 0.25f;
  return (scale * values[0] + scale * values[1] + scale * values[2]) / (3.0f * scale);
}

/// The mean of the neighbouring pixels for which `is_finite` is true; `otherwise` in each channel if there
/// are none.
template <std::size_t channels, class IsFinite>
std::array<float, channels> mean_of_neighbours(const Image& image, std::size_t pixel,
                                               const IsFinite& is_finite, float otherwise) {
  const int width = image.width();
  const int x = static_cast<int>(pixel % width);
  const int y = static_cast<int>(pixel / width);
  std::array<double, channels> sums{};  // of floats that may be the largest
  int count = 0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, image.height() - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
      const std::size_t neighbour = static_cast<std::size_t>(v) * width + u;
      if (neighbour == pixel || !is_finite(neighbour)) continue;
      for (std::size_t c = 0; c < channels; ++c) sums[c] += image.data()[channels * neighbour + c];
      ++count;
    }
  }
  std::array<float, channels> mean;
  mean.fill(otherwise);
  for (std::size_t c = 0; c < channels && count > 0; ++c) mean[c] = static_cast<float>(sums[c] / count);
  return mean;
}

}  // namespace

std::vector<std::uint8_t> finite_pixels(const Image& beauty) {
  std::vector<std::uint8_t> finite(beauty.pixel_count());
  for_each_pixel(bounds({beauty.width(), beauty.height()}), beauty.width(), [&](std::size_t i, std::size_t) {
    finite[i] = all_finite(beauty.data().subspan(i * beauty.channels(), beauty.channels())) ? 1 : 0;
  });
  return finite;
}

std::size_t count_non_finite(const std::vector<std::uint8_t>& finite, const Frame& frame) {
  const auto count = static_cast<std::size_t>(std::ranges::count(finite, 0));
  return count - std::min(count, frame.cut() ? frame.cut()->unknown_pixels : 0);
}

std::size_t count_non_finite_guides(const Frame& frame, const AovSet& used) {
  // On the bits of the values, which compilers vectorize on any processor.
  constexpr std::uint32_t infinity = 0x7f800000;
  const auto is_beyond = [](float value, std::uint32_t limit) {
    return static_cast<std::uint32_t>(std::int32_t(std::bit_cast<std::uint32_t>(value) & 0x7fffffffu) >
                                      std::int32_t(limit));
  };
  return sum_of_rows<std::size_t>(frame.height(), [&](int y) {
    std::vector<std::uint8_t> bad;  // pixels of the row; empty while none is, as in most rows
    for (const Aov aov : {Aov::albedo, Aov::normal, Aov::depth}) {
      if (!contains(used, aov)) continue;
      const Image& image = frame.image(aov);
      const auto channels = static_cast<std::size_t>(image.channels());
      const std::size_t size = static_cast<std::size_t>(image.width()) * channels;
      const auto row = image.data().subspan(static_cast<std::size_t>(y) * size, size);
      const std::uint32_t limit = aov == Aov::depth ? infinity : infinity - 1;
      std::uint32_t any = 0;
      for (const float value : row) any |= is_beyond(value, limit);
      if (any == 0) continue;
      bad.resize(static_cast<std::size_t>(image.width()));
      for (std::size_t i = 0; i < size; ++i) bad[i / channels] |= is_beyond(row[i], limit) != 0 ? 1 : 0;
    }
    return static_cast<std::size_t>(std::ranges::count(bad, 1));
  });
}

void pack_color(const Image& beauty, std::span<const std::uint8_t> finite, const Rect& rect,
                std::span<float> rgba) {
  assert(beauty.channels() == 4 && rgba.size() == rect.extent().elements() * 4);
  const int width = beauty.width();
  const auto is_finite = [&](std::size_t i) { return finite[i] != 0; };
  for_each_pixel(rect, width, [&](std::size_t in, std::size_t out) {
    const auto pixel = rgba.subspan(4 * out, 4).begin();
    if (is_finite(in)) {
      std::ranges::copy(beauty.data().subspan(4 * in, 4), pixel);
    } else {
      std::ranges::copy(mean_of_neighbours<4>(beauty, in, is_finite, 0.0f), pixel);
    }
  });
}

void pack_albedo(const Image& albedo, const Rect& rect, std::span<float> rgba) {
  assert(albedo.channels() == 3 && rgba.size() == rect.extent().elements() * 4);
  const auto is_finite = [&](std::size_t i) { return all_finite(albedo.data().subspan(3 * i, 3)); };
  for_each_pixel(rect, albedo.width(), [&](std::size_t in, std::size_t out) {
    std::array<float, 3> value{};
    std::ranges::copy(albedo.data().subspan(3 * in, 3), value.begin());
    if (!is_finite(in)) value = mean_of_neighbours<3>(albedo, in, is_finite, 1.0f);
    for (std::size_t c = 0; c < 3; ++c) rgba[4 * out + c] = std::clamp(value[c], 0.0f, 1.0f);
    rgba[4 * out + 3] = 0.0f;
  });
}

std::size_t pack_variance(const Frame& frame, const AovSet& used, std::span<const std::uint8_t> finite,
                          const Tile& tile, std::span<float> pairs) {
  const bool given = contains(used, Aov::variance);
  const bool halves = contains(used, Aov::half_a) && contains(used, Aov::half_b);
  std::atomic<std::size_t> replaced = 0;
  for_each_pixel(tile.target, frame.width(), [&](std::size_t in, std::size_t out) {
    float variance = 0.0f;
    if (given) {
      variance = mean_of_channels(frame.image(Aov::variance).data().subspan(in * 3, 3));
    } else if (halves) {
      const auto a = frame.image(Aov::half_a).data().subspan(in * 3, 3);
      const auto b = frame.image(Aov::half_b).data().subspan(in * 3, 3);
      for (int c = 0; c < 3; ++c) variance += (a[c] - b[c]) * (a[c] - b[c]) / 12.0f;
    }
    if (finite[in] && !(std::isfinite(variance) && variance >= 0.0f)) {
      const float l = luminance(frame.image(Aov::beauty).data().subspan(in * 4, 4));
      variance = l * l;
      const int x = static_cast<int>(in % frame.width());
      const int y = static_cast<int>(in / frame.width());
      if (tile.core.contains(x, y)) ++replaced;
    }
    if (pairs.empty()) return;
    pairs[2 * out] = finite[in] ? std::min(variance, kLargestVariance) : 0.0f;
    pairs[2 * out + 1] = finite[in];
  });
  return replaced;
}

float typical_depth(const Frame& frame, const AovSet& used) {
  if (!contains(used, Aov::depth)) return 1.0f;
  const Image& depth = frame.image(Aov::depth);
  const auto sum = sum_of_rows<LogarithmSum>(depth.height(), [&](int y) {
    LogarithmSum row;
    for (int x = 0; x < depth.width(); ++x) {
      const float z = depth.at(x, y, 0);
      if (z > 0.0f && z < kNothingHit) row.add(z);
    }
    return row;
  });
  return sum.count > 0 ? static_cast<float>(sum.geometric_mean()) : 1.0f;
}

void pack_features(const NewFrame& from, const AovSet& used, const Rect& rect, std::span<float> albedo_depth,
                   std::span<float> normal) {
  const Frame& frame = from.frame;
  if (contains(used, Aov::albedo)) {
    pack_albedo(from.albedo(), rect, albedo_depth);
  } else {
    std::ranges::fill(albedo_depth, 1.0f);
  }
  const bool has_depth = contains(used, Aov::depth);
  const bool has_normal = contains(used, Aov::normal);
  for_each_pixel(rect, frame.width(), [&](std::size_t in, std::size_t out) {
    const auto n = normal.subspan(4 * out, 4);
    for (std::size_t c = 0; c < 3; ++c) {
      const float axis = has_normal ? frame.image(Aov::normal).data()[3 * in + c] : 0.0f;
      n[c] = std::isfinite(axis) ? std::clamp(axis, -1.0f, 1.0f) : 0.0f;
    }
    n[3] = 0.0f;
    const float z = has_depth ? frame.image(Aov::depth).data()[in] : 0.0f;
    // Infinite depth (nothing hit) maps to the maximum; NaN and depths of 0 or less map to 0.
    albedo_depth[4 * out + 3] = z == std::numeric_limits<float>::infinity() ? 2.0f
                                : z > 0.0f ? 2.0f / (1.0f + from.usual_depth / z)
                                           : 0.0f;
  });
}

int guide_planes(bool albedo, bool normal) {
  return (albedo ? 1 : 0) + (normal ? 2 : 0);
}

void pack_guide(const Image* albedo, const Image* normal, const Rect& rect, std::span<float> planes) {
  const auto count = static_cast<std::size_t>(rect.extent().elements());
  assert(planes.size() == count * guide_planes(albedo != nullptr, normal != nullptr));
  std::size_t plane = 0;
  if (albedo) {
    const auto values = albedo->data();
    for_each_pixel(rect, albedo->width(), [&](std::size_t in, std::size_t out) {
      const float l = luminance(values.subspan(3 * in, 3));
      planes[out] = std::isfinite(l) ? std::clamp(l, 0.0f, 1.0f) : 0.0f;
    });
    ++plane;
  }
  if (normal) {
    // Orthonormal axes perpendicular to (1,1,1): the six axis directions have distinct projections onto them.
    constexpr float half_root = 0.70710678f;
    constexpr float sixth_root = 0.40824829f;
    const auto values = normal->data();
    const auto u = planes.subspan(plane * count, count);
    const auto v = planes.subspan((plane + 1) * count, count);
    for_each_pixel(rect, normal->width(), [&](std::size_t in, std::size_t out) {
      const auto n = values.subspan(3 * in, 3);
      const bool finite = all_finite(n);
      u[out] = finite ? std::clamp((n[0] - n[1]) * half_root, -1.0f, 1.0f) : 0.0f;
      v[out] = finite ? std::clamp((n[0] + n[1] - 2.0f * n[2]) * sixth_root, -1.0f, 1.0f) : 0.0f;
    });
  }
}

void pack_motion(const Image& motion, const Rect& rect, float limit_px, std::span<float> pairs) {
  assert(motion.channels() == 2 && pairs.size() == rect.extent().elements() * 2);
  constexpr float none = 1e30f;  // not known to is_known_motion of shaders/lib/motion.glsl
  for_each_pixel(rect, motion.width(), [&](std::size_t in, std::size_t out) {
    const auto pixel = motion.data().subspan(2 * in, 2);
    const bool known = is_within(pixel, limit_px);
    for (std::size_t c = 0; c < 2; ++c) pairs[2 * out + c] = known ? pixel[c] : none;
  });
}

std::size_t count_far_motions(const Image& motion, float limit_px) {
  return sum_of_rows<std::size_t>(motion.height(), [&](int y) {
    std::size_t count = 0;
    for (int x = 0; x < motion.width(); ++x) {
      if (all_finite(motion.pixel(x, y)) && !is_within(motion.pixel(x, y), limit_px)) ++count;
    }
    return count;
  });
}

float exposure(const Image& beauty) {
  /// Calls `use` with each positive, finite luminance of row y.
  const auto for_each_luminance = [&](int y, const auto& use) {
    for (int x = 0; x < beauty.width(); ++x) {
      const float l = luminance(beauty.pixel(x, y));
      if (l > 0.0f && std::isfinite(l)) use(static_cast<double>(l));
    }
  };
  const auto exponents = sum_of_rows<Exponents>(beauty.height(), [&](int y) {
    Exponents row;
    for_each_luminance(y, [&](double l) { row.add(static_cast<float>(l)); });
    return row;
  });
  if (exponents.count() == 0) return 1.0f;
  const double largest = kFirefly * std::ldexp(1.0, exponents.largest_usual());
  const double mean = sum_of_rows<double>(beauty.height(), [&](int y) {
    double row = 0.0;
    for_each_luminance(
        y, [&](double l) { row += std::min(l, largest) / static_cast<double>(beauty.pixel_count()); });
    return row;
  });
  const auto sum = sum_of_rows<LogarithmSum>(beauty.height(), [&](int y) {
    LogarithmSum row;
    for_each_luminance(y, [&](double l) {
      if (l >= 1e-6 * mean) row.add(l);
    });
    return row;
  });
  if (sum.count == 0) return 1.0f;
  return static_cast<float>(std::clamp(1.0 / sum.geometric_mean(), 1.0 / kLargestExposure, kLargestExposure));
}

}  // namespace becalm::filter
