#include "filter/input/radiance_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "filter/for_rows.h"
#include "filter/input/exponents.h"
#include "filter/luminance.h"

namespace becalm::filter {
namespace {

/// Luminances from 2 to the power of -this to that need no scale: variances down to 1e-12 of their square are
/// still within the range of floats. Other scales bring 2^(2 * this) as many exponents there.
constexpr int kUsualExponent = 40;
/// Share of the luminances that must be usual or brighter for dim ones not to count: those are then traces,
/// however many, as filters and compression leave them. Fewer are fireflies.
constexpr double kEnough = 5e-4;

constexpr std::array kRadiance{Aov::half_a,   Aov::half_b, Aov::direct,
                               Aov::indirect, Aov::bias,   Aov::accumulated};
constexpr std::array kSquaredRadiance{Aov::remaining_variance, Aov::accumulated_variance};

void multiply(std::span<float> values, float factor) {
  for (float& value : values) {
    const float product = value * factor;
    constexpr float largest = std::numeric_limits<float>::max();
    value = std::isfinite(value) ? std::clamp(product, -largest, largest) : value;
  }
}

/// Whether a square of radiance left the range of floats, or nearly did: below it where the scale enlarges.
bool is_lost(float squared, float scale) {
  using Limits = std::numeric_limits<float>;
  return scale > 1.0f ? squared >= 0.0f && squared < Limits::min() : squared == Limits::max();
}

/// Scales the variance. What of it is lost comes from the half-buffers, or is the square of the radiance;
/// both are scaled already.
void scale_variance(Frame& frame, float scale) {
  const std::span<float> variance = frame.image(Aov::variance).data();
  const std::span<const float> a = frame.image(Aov::half_a).data();
  const std::span<const float> b = frame.image(Aov::half_b).data();
  const std::span<const float> beauty = frame.image(Aov::beauty).data();
  const bool has_halves = !a.empty() && !b.empty();
  for (std::size_t i = 0; i < variance.size(); ++i) {
    const float deviation = has_halves ? 0.5f * (a[i] - b[i]) : beauty[4 * (i / 3) + i % 3];
    if (is_lost(variance[i], scale) && std::isfinite(deviation)) {
      variance[i] = deviation * deviation;
    } else {
      multiply(variance.subspan(i, 1), scale);
      multiply(variance.subspan(i, 1), scale);
    }
  }
}

bool is_finite(std::span<const float> values) {
  return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
}

/// Pixels that are not finite, from an image of the same size; nothing from an empty one. Alpha stays.
void restore_faulty_pixels(const Image& from, Image& to) {
  if (from.empty() || to.empty()) return;
  const std::size_t count = std::min(3, to.channels());
  for (int y = 0; y < to.height(); ++y) {
    for (int x = 0; x < to.width(); ++x) {
      if (!is_finite(to.pixel(x, y).first(count)))
        std::ranges::copy(from.pixel(x, y).first(count), to.pixel(x, y).begin());
    }
  }
}

/// All but the variance.
void scale_others(Frame& frame, float scale) {
  Image& beauty = frame.image(Aov::beauty);
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) multiply(beauty.data().subspan(4 * i, 3), scale);
  for (const Aov aov : kRadiance) multiply(frame.image(aov).data(), scale);
  for (LightGroup& group : frame.light_groups()) multiply(group.radiance.data(), scale);
  for (const Aov aov : kSquaredRadiance) {
    multiply(frame.image(aov).data(), scale);
    multiply(frame.image(aov).data(), scale);
  }
}

}  // namespace

float radiance_scale(const Frame& frame) {
  const Image& beauty = frame.image(Aov::beauty);
  const auto exponents = sum_of_rows<Exponents>(beauty.height(), [&](int y) {
    Exponents row;
    for (int x = 0; x < beauty.width(); ++x) row.add(luminance(beauty.pixel(x, y)));
    return row;
  });
  const std::uint64_t usual = exponents.count_between(-kUsualExponent, kUsualExponent);
  const std::uint64_t bright = exponents.count_from(kUsualExponent);
  const bool is_dim = static_cast<double>(usual + bright) < kEnough * static_cast<double>(exponents.count());
  if (is_dim) return std::ldexp(1.0f, 2 * kUsualExponent);
  return bright > usual ? std::ldexp(1.0f, -2 * kUsualExponent) : 1.0f;
}

void scale_radiance(Frame& frame, float scale) {
  scale_others(frame, scale);
  scale_variance(frame, scale);
}

void scale_radiance_back(Frame& made, float scale, const Frame& source) {
  scale_others(made, 1.0f / scale);
  // Unlike scale_radiance, keeps a variance of 0: in a result it means that no noise is left.
  for (int i = 0; i < 2; ++i) multiply(made.image(Aov::variance).data(), 1.0f / scale);
  restore_faulty_pixels(source.image(Aov::beauty), made.image(Aov::beauty));
  for (const Aov aov : kRadiance) restore_faulty_pixels(source.image(aov), made.image(aov));
  for (std::size_t i = 0; i < made.light_groups().size(); ++i)
    restore_faulty_pixels(source.light_groups()[i].radiance, made.light_groups()[i].radiance);
}

}  // namespace becalm::filter
