#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "tracer/lights/light_sample.h"
#include "tracer/lights/motion_keys.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Shines equally in all directions from a point.
struct PointLight {
  V3f position;
  V3f intensity;  ///< W/sr
  std::uint16_t group = 0;
  MotionKeys motion = {};  ///< among LightList::point_keys

  /// Emitted flux, mean of the channels.
  double power() const { return 4.0 * std::numbers::pi * channel_mean(intensity); }

  std::optional<LightSample> sample(const V3f& point) const;
};

/// The sample of a delta light of this intensity in W/sr towards the point, which is `to_light` away; nothing
/// from the light's own position. What leaves the range of float is its largest value: a light of 1e30 W/sr
/// from less than about 1e-4 away.
inline std::optional<LightSample> sample_position(const V3d& to_light, const V3d& intensity,
                                                  std::uint16_t group) {
  const double squared = to_light.length2();
  const double distance = to_light.length();
  if (!(distance > 0.0 && std::isfinite(distance))) return std::nullopt;
  V3f irradiance;
  for (int c = 0; c < 3; ++c) {
    constexpr double largest = std::numeric_limits<float>::max();
    irradiance[c] = static_cast<float>(std::min(intensity[c] / squared, largest));
  }
  return LightSample{V3f(to_light / distance), static_cast<float>(distance), irradiance, 1.0f, group, true};
}

inline std::optional<LightSample> PointLight::sample(const V3f& point) const {
  return sample_position(V3d(position) - V3d(point), V3d(intensity), group);
}

}  // namespace becalm::tracer
