#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "tracer/lights/irradiance.h"
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

  /// What arrives at the receiver if nothing is in between, as irradiance.h has it.
  double irradiance_at(const Receiver& at) const {
    return point_irradiance(at, V3d(position) - V3d(at.position), channel_mean(intensity));
  }
  /// Whether that is not 0.
  bool reaches(const Receiver& at) const { return irradiance_at(at) > 0.0; }

  double radiant_intensity() const { return channel_mean(intensity); }

  std::optional<LightSample> sample(const Receiver& at, const V2f& = V2f(0.0f)) const;
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

inline std::optional<LightSample> PointLight::sample(const Receiver& at, const V2f&) const {
  return sample_position(V3d(position) - V3d(at.position), V3d(intensity), group);
}

}  // namespace becalm::tracer
