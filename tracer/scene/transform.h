#pragma once

#include "tracer/math/keyframes.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Translation, rotation in degrees about x, y, z, and scale, over time. Angles are interpolated each by
/// itself, as animation tools do with their curves, so that keys of 0 and 720 degrees mean two full turns;
/// quaternions would take the shorter way and stand still.
using TransformCurve = Curve<9>;

/// Object to world at that frame: scale, then rotate about x, y, z, then translate.
M44d transform_at(const TransformCurve& curve, double frame);

/// Angles in degrees about x, y, z, in this order, that make the rotation, which must be one.
V3d rotation_angles_deg(const M44d& rotation);

/// Eye, target and up over time.
using LookAtCurve = Curve<9>;

struct LookAt {
  V3d eye, target, up;
};
LookAt look_at(const LookAtCurve& curve, double frame);

/// Whether eye and target differ and up is not along the view.
bool is_valid(const LookAt& look_at);

}  // namespace becalm::tracer
