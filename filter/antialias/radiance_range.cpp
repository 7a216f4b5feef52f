#include "filter/antialias/radiance_range.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "filter/input/exponents.h"
#include "shaders/shared/limits.h"

namespace becalm::filter {
namespace {

/// The scale never brings the usual colours below 2 to the power of this: variances down to 1e-12 of their
/// square stay within the range of floats.
constexpr int kLeastScaledExponent = -40;
}  // namespace

std::optional<float> scale_of(const Image& color) {
  Exponents exponents;
  for (std::size_t i = 0; i < color.data().size(); ++i) {
    if (i % 4 != 3) exponents.add(std::abs(color.data()[i]));
  }
  if (exponents.count() == 0) return std::nullopt;
  const int usual = exponents.largest_usual();
  const int unlimited = std::ilogb(kLargestScaled) - 1 - exponents.largest();
  const int exponent = std::min(-1 - usual, std::max(unlimited, kLeastScaledExponent - usual));
  return std::ldexp(1.0f, std::clamp(exponent, -120, 120));
}

void scale_colors(Image& color, float scale) {
  for (std::size_t i = 0; i < color.data().size(); ++i) {
    float& value = color.data()[i];
    if (i % 4 != 3) value = std::clamp(scale * value, -kLargestScaled, kLargestScaled);
  }
}

void rescale(Estimate& estimate, float ratio) {
  if (ratio == 1.0f) return;
  scale_colors(estimate.color, ratio);
  const std::span<float> stats = estimate.stats.data();
  for (std::size_t i = 0; i < stats.size(); i += 2)
    stats[i] = std::min(stats[i] * ratio * ratio, kLargestVariance);
}

}  // namespace becalm::filter
