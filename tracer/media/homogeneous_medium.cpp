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

}  // namespace

V3f transmittance(const HomogeneousMedium& medium, float distance) {
  V3f result;
  for (int c = 0; c < 3; ++c) {
    // 0 times an infinite distance would be NaN.
    result[c] = medium.extinction[c] == 0.0f ? 1.0f : std::exp(-medium.extinction[c] * distance);
  }
  return result;
}

MediumSample sample_distance(const HomogeneousMedium& medium, float t_max, MediumRandom& random,
                             const V3f& throughput) {
  if (is_black(medium.albedo)) return {false, t_max, transmittance(medium, t_max)};
  const V3f probabilities = channel_probabilities(throughput);
  const int channel = choose_channel(probabilities, random.next());
  const float depth = random.next_exponential();
  const float extinction = medium.extinction[channel];
  float t = std::numeric_limits<float>::infinity();
  if (extinction > 0.0f) t = std::min(depth / extinction, std::numeric_limits<float>::max());

  if (t < t_max) {
    // Relative to the largest, coefficients of 1e-30 and 1e30 stay in range. The chosen channel's terms are
    // at least 2^-25 of its own, so that the sum does not vanish.
    const V3f passed = transmittance(medium, t);
    const V3f collided = passed * medium.extinction / extinction;
    const float density = probabilities.dot(collided);
    return {true, t, medium.albedo * collided / density};
  }
  const V3f passed = transmittance(medium, t_max);
  return {false, t_max, passed / probabilities.dot(passed)};
}

}  // namespace becalm::tracer
