#include "filter/input/radiance_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "filter/luminance.h"

namespace becalm::filter {
namespace {

/// Typical luminances between the inverse of this and this are left alone: variances down to 1e-12 of their
/// square are still within the range of floats.
constexpr int kUsualExponent = 40;

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

std::optional<float> radiance_scale(const Frame& frame) {
  const Image& beauty = frame.image(Aov::beauty);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    const float l = luminance(beauty.data().subspan(4 * i, 4));
    if (!(l > 0.0f && std::isfinite(l))) continue;
    sum += std::log2(l);
    ++count;
  }
  if (count == 0) return std::nullopt;
  const double exponent = sum / static_cast<double>(count);
  if (std::abs(exponent) <= kUsualExponent) return 1.0f;
  return std::ldexp(1.0f, std::clamp(-static_cast<int>(std::lround(exponent)), -120, 120));
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
