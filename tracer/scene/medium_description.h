#pragma once

#include <variant>

#include "tracer/math/keyframes.h"
#include "tracer/media/cloud_shape.h"
#include "tracer/media/homogeneous_medium.h"

namespace becalm::tracer {

/// Clouds over time, in the box [-1,1]^3 of the object that they fill.
struct CloudDescription {
  CloudShape shape;  ///< offset, evolution and coverage are those of the curves
  Curve<3> offset = Curve<3>::Value{0, 0, 0};
  Curve<1> evolution = Curve<1>::Value{0};
  Curve<1> coverage = Curve<1>::Value{0.5};
  Curve<1> extinction = Curve<1>::Value{1};  ///< per scene unit where the density is 1
  V3f albedo{1.0f};
  float g = 0.0f;
};

using MediumDescription = std::variant<HomogeneousMedium, CloudDescription>;

}  // namespace becalm::tracer
