#pragma once

#include "tracer/media/medium.h"
#include "tracer/scene/medium_description.h"

namespace becalm::tracer {

/// Makes `medium` what is described at that frame in that place. Clouds are baked anew only if their shape
/// has changed: not for another place, extinction, albedo or g. `medium_to_world` places the box [-1,1]^3 of
/// a cloud (the transform of the object that it fills) and must be invertible; a homogeneous medium ignores
/// it. Not to be called while rays are traced through the medium.
void update_medium(const MediumDescription& description, double frame, const M44d& medium_to_world,
                   Medium& medium);

}  // namespace becalm::tracer
