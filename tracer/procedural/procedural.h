#pragma once

#include "tracer/procedural/blobs.h"
#include "tracer/procedural/ocean.h"
#include "tracer/procedural/terrain.h"

// Surfaces that are marched rather than built of triangles, at one frame and in object space. A ray's
// direction has any length and its t are multiples of it. Nothing here allocates but `update`, and all but
// that may be called from many threads.

namespace becalm::tracer {

using Procedural = std::variant<Terrain, Ocean, Blobs>;

/// Makes `procedural` what the description says of that frame, reusing what it has of another frame. Returns
/// whether it changed. Throws std::bad_alloc.
bool update(const ProceduralDescription& description, double frame, Procedural& procedural);

Imath::Box3f bounds(const Procedural& procedural);

/// The first crossing of the surface from either side, t in [t_min, t_max]: within 4e-6 of the surface in
/// units of its size. None for a ray that is not finite or has no direction.
std::optional<float> intersect(const Procedural& procedural, const V3f& origin, const V3f& dir, float t_min,
                               float t_max);

/// The surface next to `p`, a point on it but for rounding: below or above it for height fields, along the
/// gradient for blobs. `footprint` is the length, in object units, that the normal is averaged over.
ProceduralPoint point(const Procedural& procedural, const V3f& p, float footprint = 0.0f);

/// Where the point `p` of the surface was a frame before. Points of height fields go up and down, with the
/// waves or with the terrain's height (not its erosion). Blobs have no points to follow: they stay.
V3f point_before(const Procedural& procedural, const V3f& p);

/// Memory held beyond the object itself.
std::size_t bytes(const Procedural& procedural);

}  // namespace becalm::tracer
