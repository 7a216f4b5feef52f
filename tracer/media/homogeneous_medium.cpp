#include "tracer/media/homogeneous_medium.h"

#include <limits>

namespace becalm::tracer {

namespace {

/// Probabilities in proportion to the throughput, whatever its scale.
V3f channel_probabilities(const V3f& throughput) {
  const float largest = max_component(throughput);
  if (!(largest > 0.0f) || !is_finite(throughput)) return V3f(1.0f / 3.0f);
  const V3f relative = throughput / largest;
  return relative / (relative.x + relative.y + relative.z);
}

int choose_channel(const V3f& probabilities, float u) {
  if (u < probabilities.x) return 0;
  return u < probabilities.x + probabilities.y || probabilities.z == 0.0f ? 1 : 2;
}

/// The way to the next collision, by the extinction of one channel.
struct FreePath {
  V3f probabilities;  ///< of the channels
  float extinction;   ///< of the one chosen
  float t;            ///< infinite without extinction

  FreePath(const HomogeneousMedium& medium, MediumRandom& random, const V3f& throughput)
      : probabilities(channel_probabilities(throughput)), t(std::numeric_limits<float>::infinity()) {
    extinction = medium.extinction[choose_channel(probabilities, random.next())];
    const float depth = random.next_exponential();
    if (extinction > 0.0f) t = std::min(depth / extinction, std::numeric_limits<float>::max());
  }
};

}  // namespace

V3f transmittance(const HomogeneousMedium& medium, float distance) {
  V3f result;
  for (int c = 0; c < 3; ++c) {
    // 0 times an infinite distance would be NaN.
    result[c] = medium.extinction[c] == 0.0f ? 1.0f : std::exp(-medium.extinction[c] * distance);
  }
  return result;
}

std::optional<float> sample_absorption(const HomogeneousMedium& medium, float t_max, MediumRandom& random,
                                       const V3f& throughput) {
  if (!is_black(medium.albedo)) return std::nullopt;
  const FreePath path(medium, random, throughput);
  return path.t < t_max ? std::optional(path.t) : std::nullopt;
}

MediumSample sample_distance(const HomogeneousMedium& medium, float t_max, MediumRandom& random,
                             const V3f& throughput) {
  if (is_black(medium.albedo)) return {false, t_max, transmittance(medium, t_max)};
  const FreePath path(medium, random, throughput);
  if (path.t < t_max) {
    // Relative to the largest, coefficients of 1e-30 and 1e30 stay in range. The chosen channel's terms are
    // at least 2^-25 of its own, so that the sum does not vanish.
    const V3f passed = transmittance(medium, path.t);
    const V3f collided = passed * medium.extinction / path.extinction;
    const float density = path.probabilities.dot(collided);
    return {true, path.t, medium.albedo * collided / density};
  }
  const V3f passed = transmittance(medium, t_max);
  return {false, t_max, passed / path.probabilities.dot(passed)};
}

}  // namespace becalm::tracer
