#include "tracer/scene/load/obj.h"

#include <tiny_obj_loader.h>

#include <map>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include "frame/error.h"
#include "tracer/scene/load/text_file.h"
#include "tracer/scene/load/text_words.h"

namespace becalm::tracer {

namespace {

/// tinyobjloader reads what is not a number as 0, so coordinates are checked here first.
void check_coordinates(const std::string& path, std::string_view text) {
  for (int line_number = 1; !text.empty(); ++line_number) {
    std::string_view line = take_line(text);
    const std::string_view kind = take_word(line);
    const int needed = kind == "v" || kind == "vn" ? 3 : kind == "vt" ? 2 : 0;
    for (int i = 0; i < needed; ++i) {
      const std::string_view word = take_word(line);
      if (!is_float(word)) {
        fail_in_file(path, fmt::format("line {}: '{}' needs {} finite numbers, found '{}'", line_number, kind,
                                       needed, word));
      }
    }
  }
}

/// Numbers the materials that faces may name, without reading any file of them: tinyobjloader gives faces of
/// unknown materials no number.
class MaterialNames : public tinyobj::MaterialReader {
 public:
  explicit MaterialNames(std::string_view text) {
    while (!text.empty()) {
      std::string_view line = take_line(text);
      if (take_word(line) != "usemtl") continue;
      const std::string name(take_word(line));
      if (numbers_.try_emplace(name, static_cast<int>(names_.size())).second) names_.push_back(name);
    }
  }
  bool operator()(const std::string&, std::vector<tinyobj::material_t>*, std::map<std::string, int>* numbers,
                  std::string*, std::string*) override {
    *numbers = numbers_;
    return true;
  }
  /// Of a face's number; empty for faces before the first material.
  const std::string& name(int number) const {
    static const std::string none;
    return number < 0 ? none : names_[static_cast<std::size_t>(number)];
  }

 private:
  std::vector<std::string> names_;
  std::map<std::string, int> numbers_;
};

struct Parsed {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
};

Parsed parse(const std::string& path, const std::string& text, MaterialNames* names, bool triangulate) {
  Parsed parsed;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  // The reader of materials is asked for each library that is named.
  std::istringstream stream(names != nullptr ? "mtllib names\n" + text : text);
  if (!tinyobj::LoadObj(&parsed.attributes, &parsed.shapes, &materials, &warning, &error, &stream, names,
                        triangulate, false)) {
    while (!error.empty() && (error.back() == '\n' || error.back() == '\r')) error.pop_back();
    std::replace(error.begin(), error.end(), '\n', ' ');
    fail_in_file(path, error.empty() ? "not a readable OBJ file" : error);
  }
  return parsed;
}

void check_index(const std::string& path, std::size_t face, const char* what, int index, std::size_t count) {
  if (index >= 0 && static_cast<std::size_t>(index) < count) return;
  fail_in_file(path,
               fmt::format("face {}: {} index {} is outside the file's {}", face, what, index + 1, count));
}

/// Throws for indices out of range. Returns whether all faces are triangles. Faces are counted from 1 in file
/// order.
bool check_faces(const std::string& path, const Parsed& parsed) {
  const tinyobj::attrib_t& attributes = parsed.attributes;
  bool all_triangles = true;
  std::size_t face = 0;
  for (const tinyobj::shape_t& shape : parsed.shapes) {
    std::size_t corner = 0;
    for (const unsigned corner_count : shape.mesh.num_face_vertices) {
      ++face;
      all_triangles = all_triangles && corner_count == 3;
      for (unsigned i = 0; i < corner_count; ++i, ++corner) {
        const tinyobj::index_t& index = shape.mesh.indices[corner];
        check_index(path, face, "vertex", index.vertex_index, attributes.vertices.size() / 3);
        // -1 says that the corner has none.
        if (index.normal_index != -1) {
          check_index(path, face, "normal", index.normal_index, attributes.normals.size() / 3);
        }
        if (index.texcoord_index != -1) {
          check_index(path, face, "uv", index.texcoord_index, attributes.texcoords.size() / 2);
        }
      }
    }
  }
  if (face == 0) fail_in_file(path, "has no faces");
  return all_triangles;
}

struct CornerHash {
  std::size_t operator()(const tinyobj::index_t& i) const {
    return (static_cast<std::size_t>(i.vertex_index) * 73856093u) ^
           (static_cast<std::size_t>(i.normal_index) * 19349663u) ^
           (static_cast<std::size_t>(i.texcoord_index) * 83492791u);
  }
};
struct SameCorner {
  bool operator()(const tinyobj::index_t& a, const tinyobj::index_t& b) const {
    return a.vertex_index == b.vertex_index && a.normal_index == b.normal_index &&
           a.texcoord_index == b.texcoord_index;
  }
};

/// Corners that agree in position, normal and uv become one vertex. `faces(visit)` calls visit(corners) with
/// the three corners of each triangle.
template <class Faces>
Mesh merge_corners(const tinyobj::attrib_t& attributes, const Faces& faces) {
  bool with_normals = true, with_uvs = true;
  faces([&](const tinyobj::index_t* corners) {
    for (int i = 0; i < 3; ++i) {
      with_normals = with_normals && corners[i].normal_index >= 0;
      with_uvs = with_uvs && corners[i].texcoord_index >= 0;
    }
  });
  Mesh mesh;
  std::unordered_map<tinyobj::index_t, std::uint32_t, CornerHash, SameCorner> vertices;
  const auto vertex = [&](tinyobj::index_t corner) {
    if (!with_normals) corner.normal_index = -1;
    if (!with_uvs) corner.texcoord_index = -1;
    const auto [entry, is_new] =
        vertices.try_emplace(corner, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) {
      const float* p = &attributes.vertices[3 * corner.vertex_index];
      mesh.positions.emplace_back(p[0], p[1], p[2]);
      if (with_normals) {
        const float* n = &attributes.normals[3 * corner.normal_index];
        mesh.normals.emplace_back(n[0], n[1], n[2]);
      }
      if (with_uvs) {
        const float* uv = &attributes.texcoords[2 * corner.texcoord_index];
        mesh.uvs.emplace_back(uv[0], uv[1]);
      }
    }
    return entry->second;
  };
  faces([&](const tinyobj::index_t* corners) {
    mesh.triangles.push_back({vertex(corners[0]), vertex(corners[1]), vertex(corners[2])});
  });
  return mesh;
}

std::string read_text(const std::string& path) {
  std::optional<std::string> contents = read_text_file(path);
  if (!contents) fail_in_file(path, "cannot read the mesh file");
  return std::move(*contents);
}

/// Triangles, with materials' numbers if names are given.
Parsed parse_checked(const std::string& path, const std::string& text, MaterialNames* names) {
  check_coordinates(path, text);
  // tinyobjloader drops faces with bad indices while it triangulates, so faces are checked as they stand in
  // the file.
  Parsed parsed = parse(path, text, names, false);
  if (!check_faces(path, parsed)) parsed = parse(path, text, names, true);
  return parsed;
}

}  // namespace

Mesh load_obj(const std::string& path) {
  const Parsed parsed = parse_checked(path, read_text(path), nullptr);
  Mesh mesh = merge_corners(parsed.attributes, [&](const auto& visit) {
    for (const tinyobj::shape_t& shape : parsed.shapes) {
      const std::vector<tinyobj::index_t>& corners = shape.mesh.indices;
      for (std::size_t i = 0; i + 2 < corners.size(); i += 3) visit(&corners[i]);
    }
  });
  if (mesh.triangles.empty()) fail_in_file(path, "has no faces");
  return mesh;
}

ObjParts load_obj_parts(const std::string& path) {
  const std::string text = read_text(path);
  MaterialNames names(text);
  const Parsed parsed = parse_checked(path, text, &names);

  ObjParts result;
  std::map<int, std::size_t> numbers;  // of the parts, by material
  std::vector<std::vector<const tinyobj::index_t*>> faces;
  for (const tinyobj::shape_t& shape : parsed.shapes) {
    for (std::size_t i = 0; i < shape.mesh.material_ids.size(); ++i) {
      const int material = shape.mesh.material_ids[i];
      const auto [part, is_new] = numbers.try_emplace(material, faces.size());
      if (is_new) {
        faces.emplace_back();
        result.parts.push_back({names.name(material), {}});
      }
      faces[part->second].push_back(&shape.mesh.indices[3 * i]);
    }
  }
  if (faces.empty()) fail_in_file(path, "has no faces");
  for (std::size_t i = 0; i < faces.size(); ++i) {
    result.parts[i].mesh = merge_corners(parsed.attributes, [&](const auto& visit) {
      for (const tinyobj::index_t* corners : faces[i]) visit(corners);
    });
  }
  for (std::string_view rest = text; !rest.empty();) {
    std::string_view line = take_line(rest);
    if (take_word(line) == "mtllib") result.material_libraries.emplace_back(trimmed(line));
  }
  return result;
}

}  // namespace becalm::tracer
