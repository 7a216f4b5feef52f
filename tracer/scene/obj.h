#pragma once

#include <string>

#include "tracer/scene/mesh.h"

namespace becalm::tracer {

/// All faces of a Wavefront OBJ file as one mesh, polygons cut into triangles; its materials are ignored.
/// Normals and uvs are kept only where every corner of the file has them. Throws Error(bad_input), one line
/// naming the file and the line or face, for: a file that cannot be read, a coordinate that is not a finite
/// number, an index without its element, no faces at all.
Mesh load_obj(const std::string& path);

}  // namespace becalm::tracer
