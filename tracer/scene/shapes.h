#pragma once

#include "tracer/scene/mesh.h"

namespace becalm::tracer {

/// [-1,1]^2 in the xz plane facing +y; uv (0,0) at (-1, +1) and (1,1) at (+1, -1), so that a picture lies
/// upright seen from above with -z up.
Mesh make_rectangle();

/// Radius 1 in the xz plane facing +y, as a fan of `segments` >= 3 triangles around the centre, with the area
/// of the exact disc: its corners lie slightly outside the radius.
Mesh make_disc(int segments);

/// Radius 1, smooth normals; `segments` >= 3 around the y axis, half as many from pole to pole. u runs
/// around, v from the south pole to the north.
Mesh make_sphere(int segments);

/// [-1,1]^3, faces outward, uv [0,1]^2 on each.
Mesh make_cube();

}  // namespace becalm::tracer
