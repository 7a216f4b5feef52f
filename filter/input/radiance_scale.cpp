#include "filter/input/radiance_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "filter/for_rows.h"
#include "filter/input/exponents.h"
#include "filter/luminance.h"

namespace becalm::filter {
namespace {

/// Typical luminances from 2 to the power of -this to that are left alone: variances down to 1e-12 of their
/// square are still within the range of floats. Scales are powers of 2^(2 * this).
constexpr int kUsualExponent = 40;
/// A present scale is kept up to this, so that noise does not change it from frame to frame.
constexpr int kBearableExponent = 50;
constexpr int kLargestExponent = 120;  ///< of a scale

constexpr std::array kRadiance{Aov::half_a,   Aov::half_b, Aov::direct,
                               Aov::indirect, Aov::bias,   Aov::accumulated};
constexpr std::array kSquaredRadiance{Aov::variance, Aov::remaining_variance, Aov::accumulated_variance};

void multiply(std::span<float> values, float factor) {
  for (float& value : values) {
    const float product = value * factor;
    constexpr float largest = std::numeric_limits<float>::max();
    value = std::isfinite(value) ? std::clamp(product, -largest, largest) : value;
  }
}

}  // namespace

std::optional<float> radiance_scale(const Frame& frame, std::optional<float> present) {
  const Image& beauty = frame.image(Aov::beauty);
  const auto exponents = sum_of_rows<Exponents>(beauty.height(), [&](int y) {
    Exponents row;
    for (int x = 0; x < beauty.width(); ++x) row.add(luminance(beauty.pixel(x, y)));
    return row;
  });
  if (exponents.count() == 0) return present;
  const double exponent = exponents.mean();
  if (present && std::abs(exponent + std::ilogb(*present)) <= kBearableExponent) return present;
  const int steps = static_cast<int>(std::lround(exponent / (2 * kUsualExponent)));
  return std::ldexp(1.0f, std::clamp(-2 * kUsualExponent * steps, -kLargestExponent, kLargestExponent));
}

void scale_radiance(Frame& frame, float scale) {
  Image& beauty = frame.image(Aov::beauty);
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) multiply(beauty.data().subspan(4 * i, 3), scale);
  for (const Aov aov : kRadiance) multiply(frame.image(aov).data(), scale);
  for (LightGroup& group : frame.light_groups()) multiply(group.radiance.data(), scale);
  for (const Aov aov : kSquaredRadiance) {
    multiply(frame.image(aov).data(), scale);
    multiply(frame.image(aov).data(), scale);
  }
}

}  // namespace becalm::filter
