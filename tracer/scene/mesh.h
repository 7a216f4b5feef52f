#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Triangles in object space. Normals and uvs are for each vertex or absent; counter-clockwise corners face
/// outward.
struct Mesh {
  std::vector<V3f> positions;
  std::vector<V3f> normals;  ///< empty: the triangles are flat
  std::vector<V2f> uvs;      ///< empty: (0, 0) everywhere; v points up in the picture
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::size_t bytes() const {
    return positions.capacity() * sizeof(V3f) + normals.capacity() * sizeof(V3f) +
           uvs.capacity() * sizeof(V2f) + triangles.capacity() * sizeof(triangles[0]);
  }
};

}  // namespace becalm::tracer
