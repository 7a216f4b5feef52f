#pragma once

#include <span>

#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer {

/// Adds the triangles and spheres of the objects that emit at `time` (in frames, the middle of the shutter's
/// interval), with their motion in it, and tells each object its emission and its first light's number.
void add_emissive_objects(const SceneDescription& description, double time, std::span<ObjectState> objects,
                          LightList& lights);

}  // namespace becalm::tracer
