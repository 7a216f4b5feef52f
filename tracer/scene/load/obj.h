#pragma once

#include <string>
#include <vector>

#include "tracer/scene/mesh.h"

namespace becalm::tracer {

/// All faces of a Wavefront OBJ file as one mesh, polygons cut into triangles; its materials are ignored.
/// Normals and uvs are kept only where every corner of the file has them. Throws Error(bad_input), one line
/// naming the file and the line or face, for: a file that cannot be read, a coordinate that is not a finite
/// number, an index without its element, no faces at all. Any number of files may be loaded at a time.
Mesh load_obj(const std::string& path);

/// The faces of one material.
struct ObjPart {
  std::string material;  ///< as `usemtl` names it; empty before the first
  Mesh mesh;  ///< has the vertices that its faces use, and normals and uvs as its own corners allow
};

/// What an OBJ file consists of, by material in the order of their first faces.
struct ObjParts {
  std::vector<ObjPart> parts;
  std::vector<std::string> material_libraries;  ///< of `mtllib`, as the file names them
};

/// As load_obj, a mesh for each material. The material files are not read: see load_mtl.
ObjParts load_obj_parts(const std::string& path);

}  // namespace becalm::tracer
