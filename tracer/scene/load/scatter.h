#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracer/scene/scene_description.h"

namespace becalm::tracer {

/// Copies of an object over a rectangle of the xz plane, each turned about y, leaned, scaled and moved at
/// random. The same for the same settings on every machine.
struct Scatter {
  std::uint32_t count = 1;
  std::uint32_t seed = 0;
  double x0 = -1.0, z0 = -1.0, x1 = 1.0, z1 = 1.0;  ///< the rectangle's corners, scene units
  double scale_low = 1.0, scale_high = 1.0;         ///< of the copy over the object
  double tilt_deg = 0.0;                            ///< leans by at most so much from the upright
};

/// The copies stand evenly spread (a low-discrepancy sequence), and so do the first n of more copies. Each
/// one's own transform acts before the scatter's. With a `ground`, the parts of one object, they are moved up
/// or down onto its topmost point; those that miss it are left out. The object and the ground must stand
/// still. Throws Error(bad_input) for a ground whose place and scale are beyond kLargestCoordinate.
std::vector<Object> scattered_copies(const Object& object, const Scatter& scatter,
                                     const SceneDescription& scene, std::span<const Object> ground);

}  // namespace becalm::tracer
