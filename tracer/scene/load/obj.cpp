#include "tracer/scene/load/obj.h"

#include <bit>
#include <map>
#include <span>

#include "tracer/sampling/sobol.h"
#include "tracer/scene/load/fail_in_file.h"
#include "tracer/scene/load/obj_text.h"
#include "tracer/scene/load/polygon.h"

namespace becalm::tracer {

namespace {

using Triangle = std::array<ObjCorner, 3>;

/// Cuts the file's faces into triangles.
class FaceCutter {
 public:
  explicit FaceCutter(const ObjText& obj) : obj_(obj) {}

  /// Appends those of one face.
  void cut(std::size_t face, std::vector<Triangle>& triangles) {
    const std::size_t first = face == 0 ? 0 : obj_.face_ends[face - 1];
    const std::span corners = std::span(obj_.corners).subspan(first, obj_.face_ends[face] - first);
    points_.clear();
    for (const ObjCorner& corner : corners)
      points_.push_back(obj_.positions[static_cast<std::size_t>(corner.position)]);
    cut_.clear();
    cut_polygon(points_, cut_);
    for (const auto& [a, b, c] : cut_) triangles.push_back({corners[a], corners[b], corners[c]});
  }

 private:
  const ObjText& obj_;
  std::vector<V3f> points_;                        // of the face
  std::vector<std::array<std::uint32_t, 3>> cut_;  // the face's triangles
};

/// Numbers what corners consist of, in the order in which it comes first: a hash table with open addresses.
class CornerNumbers {
 public:
  explicit CornerNumbers(std::size_t most_corners) : slots_(std::bit_ceil(2 * most_corners), kEmpty) {}

  std::uint32_t number(const ObjCorner& corner) {
    const std::uint64_t normal_and_uv = (std::uint64_t{static_cast<std::uint32_t>(corner.normal)} << 32) |
                                        static_cast<std::uint32_t>(corner.uv);
    const std::uint64_t key =
        mix_bits(normal_and_uv * 0x9e3779b97f4a7c15ull + static_cast<std::uint32_t>(corner.position));
    for (std::size_t slot = key;; ++slot) {
      std::uint32_t& number = slots_[slot & (slots_.size() - 1)];
      if (number == kEmpty) {
        number = static_cast<std::uint32_t>(corners_.size());
        corners_.push_back(corner);
        return number;
      }
      if (corners_[number] == corner) return number;
    }
  }
  /// By their numbers.
  const std::vector<ObjCorner>& corners() const { return corners_; }

 private:
  static constexpr std::uint32_t kEmpty = ~0u;
  std::vector<std::uint32_t> slots_;
  std::vector<ObjCorner> corners_;
};

/// Corners that agree in position, normal and uv become one vertex.
Mesh make_mesh(const ObjText& obj, const std::vector<Triangle>& triangles) {
  bool with_normals = true, with_uvs = true;
  for (const Triangle& triangle : triangles) {
    for (const ObjCorner& corner : triangle) {
      with_normals = with_normals && corner.normal != ObjCorner::kNone;
      with_uvs = with_uvs && corner.uv != ObjCorner::kNone;
    }
  }
  CornerNumbers numbers(3 * triangles.size());
  const auto vertex = [&](ObjCorner corner) {
    if (!with_normals) corner.normal = ObjCorner::kNone;
    if (!with_uvs) corner.uv = ObjCorner::kNone;
    return numbers.number(corner);
  };
  Mesh mesh;
  mesh.triangles.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({vertex(a), vertex(b), vertex(c)});

  mesh.positions.reserve(numbers.corners().size());
  if (with_normals) mesh.normals.reserve(numbers.corners().size());
  if (with_uvs) mesh.uvs.reserve(numbers.corners().size());
  for (const ObjCorner& corner : numbers.corners()) {
    mesh.positions.push_back(obj.positions[static_cast<std::size_t>(corner.position)]);
    if (with_normals) mesh.normals.push_back(obj.normals[static_cast<std::size_t>(corner.normal)]);
    if (with_uvs) mesh.uvs.push_back(obj.uvs[static_cast<std::size_t>(corner.uv)]);
  }
  return mesh;
}

ObjText read_obj_with_faces(const std::string& path) {
  ObjText obj = read_obj(path);
  if (obj.face_ends.empty()) fail_in_file(path, "has no faces");
  return obj;
}

}  // namespace

Mesh load_obj(const std::string& path) {
  const ObjText obj = read_obj_with_faces(path);
  FaceCutter cutter(obj);
  std::vector<Triangle> triangles;
  triangles.reserve(obj.corners.size() - 2 * obj.face_ends.size());
  for (std::size_t face = 0; face < obj.face_ends.size(); ++face) cutter.cut(face, triangles);
  return make_mesh(obj, triangles);
}

ObjParts load_obj_parts(const std::string& path) {
  const ObjText obj = read_obj_with_faces(path);
  FaceCutter cutter(obj);
  ObjParts result;
  std::map<std::string, std::size_t> numbers;    // of the parts, by material
  std::vector<std::vector<Triangle>> triangles;  // of each part
  std::string material;
  auto next = obj.materials.begin();
  for (std::size_t face = 0; face < obj.face_ends.size(); ++face) {
    for (; next != obj.materials.end() && next->first_face <= face; ++next) material = next->name;
    const auto [part, is_new] = numbers.try_emplace(material, triangles.size());
    if (is_new) {
      triangles.emplace_back();
      result.parts.push_back({material, {}});
    }
    cutter.cut(face, triangles[part->second]);
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) result.parts[i].mesh = make_mesh(obj, triangles[i]);
  result.material_libraries = obj.libraries;
  return result;
}

}  // namespace becalm::tracer
