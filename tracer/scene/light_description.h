#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "tracer/lights/lights.h"
#include "tracer/math/keyframes.h"

// The lights of a scene file over time. What has a surface is an object that emits.

namespace becalm::tracer {

struct PointDescription {
  Curve<3> position;
  Curve<3> intensity;  ///< W/sr
  std::uint16_t group = 0;
};

struct SpotDescription {
  Curve<3> position;
  Curve<3> aim;        ///< a point, or a direction
  bool aim_is_target;  ///< whether it is a point
  Curve<3> intensity;  ///< W/sr, inside the inner cone
  Curve<1> inner_deg;  ///< between the axis and where the falloff starts
  Curve<1> outer_deg;  ///< between the axis and where it ends
  std::uint16_t group = 0;
};

/// The direction to a sun by its place in the sky: azimuth from -z towards +x, elevation above the horizon.
struct SkyPosition {
  Curve<1> azimuth_deg;
  Curve<1> elevation_deg;
};

struct SunDescription {
  std::variant<Curve<3>, SkyPosition> direction;  ///< towards the sun
  Curve<1> diameter_deg;
  Curve<3> irradiance;  ///< on a surface that faces it, W/m^2
  std::uint16_t group = 0;
};

using LightDescription = std::variant<PointDescription, SpotDescription, SunDescription>;

/// Whether the light ever changes.
bool animated(const LightDescription& light);

/// Whether its place changes over time, so that it may move while the shutter is open. Suns never do.
bool moves(const LightDescription& light);

/// When the shutter is open, in frames, and into how many linear pieces motion in it is cut.
struct ShutterInterval {
  double open;
  double close;
  std::uint32_t segments;
};

/// Adds the lights to the list. Points and spots whose place differs between the times at which the pieces
/// meet move; all else is as in the middle of the interval.
void add_lights(std::span<const LightDescription> lights, const ShutterInterval& shutter, LightList& list);

}  // namespace becalm::tracer
