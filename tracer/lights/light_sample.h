#pragma once

#include <cstdint>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A direction drawn towards a light. A delta light (a point, a spot, a sun without size) has no
/// density that a ray could be drawn against: its sample must not be weighed against other samplers.
struct LightSample {
  V3f dir_world;   ///< unit, from the shaded point to the light
  float distance;  ///< scene units; inf for the environment and suns
  /// That arrives if nothing is in between. Delta: irradiance at normal incidence, which a positional light
  /// gives by intensity / distance^2.
  V3f radiance;
  /// Including the probability of having chosen this light; finite and > 0. Delta: that probability alone.
  float pdf_solid_angle;
  std::uint16_t group;
  bool delta;
  float extent = 0.0f;  ///< largest coordinate of the emitter's surface: its rounding errors grow with it
};

/// Mean of the channels, the measure of light for choices among lights.
inline double channel_mean(const V3f& v) {
  return (static_cast<double>(v.x) + v.y + v.z) / 3.0;
}

}  // namespace becalm::tracer
