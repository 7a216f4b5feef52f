#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A corner of a face: numbers, from 0, of the file's elements.
struct ObjCorner {
  static constexpr int kNone = -1;  ///< the corner has no normal, or no uv
  int position, normal, uv;
  friend bool operator==(const ObjCorner&, const ObjCorner&) = default;
};

/// The statements of a Wavefront OBJ file that make meshes, in the file's order.
struct ObjText {
  struct UseMaterial {
    std::uint32_t first_face;  ///< until the next one's
    std::string name;
  };
  std::vector<V3f> positions;
  std::vector<V3f> normals;
  std::vector<V2f> uvs;
  std::vector<ObjCorner> corners;        ///< of all faces, one face after the other
  std::vector<std::uint32_t> face_ends;  ///< for each face of at least 3 corners, where its corners end
  std::vector<UseMaterial> materials;    ///< of `usemtl`
  std::vector<std::string> libraries;    ///< of `mtllib`: the rest of the line
};

/// Reads the file in one pass, blocks of lines in parallel. Throws Error(bad_input) as load_obj does, but for
/// a file without faces.
ObjText read_obj(const std::string& path);

}  // namespace becalm::tracer
