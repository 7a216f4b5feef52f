#pragma once

#include <span>

#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer {

/// Adds the triangles and spheres of the objects that emit at that frame, with their motion while the shutter
/// is open, and tells each object its emission and its first light's number.
void add_emissive_objects(const SceneDescription& description, int frame, std::span<ObjectState> objects,
                          LightList& lights);

}  // namespace becalm::tracer
