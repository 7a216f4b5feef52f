#pragma once

#include <Imath/ImathBox.h>

#include <numbers>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The directions within an angle of an axis, as bound of where surfaces face.
struct DirectionBounds {
  V3d axis{0.0, 0.0, 1.0};              ///< unit
  double angle_rad = std::numbers::pi;  ///< all around
};

/// The smallest such bounds around both, but for rounding.
DirectionBounds unite(const DirectionBounds& a, const DirectionBounds& b);

/// Where emitters are and where they shine: from inside `box`, up to `emission_rad` away from any of the
/// directions `facing`. Source: Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive
/// Tree Splitting", 2018, section 4.1.
struct LightBounds {
  Imath::Box3d box;
  DirectionBounds facing;
  double emission_rad = std::numbers::pi / 2.0;
  bool two_sided = false;  ///< shines opposite to `facing` as well
  double intensity = 0.0;  ///< radiant intensity in its strongest direction, mean of the channels
};

LightBounds unite(const LightBounds& a, const LightBounds& b);

/// What a cluster costs to be sampled as one (the paper's section 4.4): intensity times the measure of the
/// directions that it shines in times its size squared. Differs from the paper: the squared diagonal stands
/// for the surface area, which is 0 for points on a line.
double cluster_cost(const LightBounds& bounds);

}  // namespace becalm::tracer
