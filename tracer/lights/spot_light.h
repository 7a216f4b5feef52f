#pragma once

#include <cstdint>
#include <numbers>
#include <optional>

#include "tracer/lights/cone.h"
#include "tracer/lights/point_light.h"

namespace becalm::tracer {

/// A place of a moving spot.
struct SpotKey {
  V3f position;
  V3f direction;  ///< any length but 0
};

/// Shines from a point into a cone: with its whole intensity up to `inner_deg` from the direction, then less,
/// by a smoothstep in the cosine, to nothing at `outer_deg`. 0 <= inner_deg <= outer_deg <= 180.
struct SpotLight {
  V3f position;
  V3f direction;  ///< in which it shines; any length but 0
  V3f intensity;  ///< W/sr, inside the inner cone
  float inner_deg;
  float outer_deg;
  std::uint16_t group = 0;
  MotionKeys motion = {};  ///< among LightList::spot_keys
};

/// A spot light, prepared for sampling.
struct SpotEmitter {
  V3f position;
  V3d axis;             ///< unit; 0 without a direction
  double inner, outer;  ///< versines: a spot of 0.01 degrees has an edge as smooth as any
  V3f intensity;
  std::uint16_t group;
  MotionKeys motion;

  explicit SpotEmitter(const SpotLight& spot)
      : position(spot.position),
        axis(V3d(spot.direction).normalized()),
        inner(versine(spot.inner_deg * std::numbers::pi / 180.0)),
        outer(versine(spot.outer_deg * std::numbers::pi / 180.0)),
        intensity(spot.intensity),
        group(spot.group),
        motion(spot.motion) {}

  /// The share of the intensity that leaves along the unit direction.
  double falloff(const V3d& dir) const {
    if (!has_direction(axis)) return 0.0;
    const double v = 0.5 * (dir - axis).length2();  // versine of the angle between unit vectors
    if (v >= outer) return 0.0;
    if (v <= inner) return 1.0;
    const double t = (outer - v) / (outer - inner);
    return t * t * (3.0 - 2.0 * t);
  }
  /// Whether that is not 0.
  bool reaches(const Receiver& at) const { return irradiance_at(at) > 0.0; }

  /// 0 without a direction or an opening.
  double radiant_intensity() const {
    return has_direction(axis) && outer > 0.0 ? channel_mean(intensity) : 0.0;
  }

  /// What arrives at the receiver if nothing is in between, as irradiance.h has it.
  double irradiance_at(const Receiver& at) const {
    const V3d to_light = V3d(position) - V3d(at.position);
    return point_irradiance(at, to_light, falloff(-to_light.normalized()) * channel_mean(intensity));
  }

  std::optional<LightSample> sample(const Receiver& at, const V2f& = V2f(0.0f)) const {
    const V3d to_light = V3d(position) - V3d(at.position);
    const double share = falloff(-to_light.normalized());
    if (share == 0.0) return std::nullopt;
    return sample_position(to_light, V3d(intensity) * share, group);
  }
};

}  // namespace becalm::tracer
