#include "tracer/scene/obj.h"

#include <tiny_obj_loader.h>

#include <charconv>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include "frame/error.h"
#include "tracer/scene/text_file.h"

namespace becalm::tracer {

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw Error(ExitStatus::bad_input, path + ": " + message);
}

/// The next word of the line, removed from it; empty at its end.
std::string_view take_word(std::string_view& line) {
  constexpr std::string_view blank = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(blank), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(blank));
  line.remove_prefix(word.size());
  return word;
}

/// tinyobjloader reads what is not a number as 0, so coordinates are checked here first.
void check_coordinates(const std::string& path, std::string_view text) {
  for (int line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string_view kind = take_word(line);
    const int needed = kind == "v" || kind == "vn" ? 3 : kind == "vt" ? 2 : 0;
    for (int i = 0; i < needed; ++i) {
      std::string_view word = take_word(line);
      std::string_view digits = word;
      if (digits.starts_with('+')) digits.remove_prefix(1);
      double value = 0.0;  // holds denormal floats as well
      const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      const bool is_number = error == std::errc() && stop == digits.data() + digits.size();
      if (!is_number || !(std::abs(value) <= std::numeric_limits<float>::max())) {
        fail(path, fmt::format("line {}: '{}' needs {} finite numbers, found '{}'", line_number, kind, needed,
                               word));
      }
    }
  }
}

/// The words of the lines that begin with `keyword`: the rest of such a line, without blanks around it.
std::vector<std::string> rests_of_lines(std::string_view text, std::string_view keyword) {
  std::vector<std::string> rests;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (take_word(line) != keyword) continue;
    constexpr std::string_view blank = " \t\r";
    line.remove_prefix(std::min(line.find_first_not_of(blank), line.size()));
    rests.emplace_back(line.substr(0, line.find_last_not_of(blank) + 1));
  }
  return rests;
}

/// Numbers the materials that the faces name, without reading any file of them: tinyobjloader gives faces of
/// unknown materials no number.
class MaterialNames : public tinyobj::MaterialReader {
 public:
  explicit MaterialNames(std::string_view text) {
    for (std::string& name : rests_of_lines(text, "usemtl")) {
      if (numbers_.try_emplace(name, static_cast<int>(names.size())).second) names.push_back(std::move(name));
    }
  }
  bool operator()(const std::string&, std::vector<tinyobj::material_t>*, std::map<std::string, int>* numbers,
                  std::string*, std::string*) override {
    *numbers = numbers_;
    return true;
  }
  std::vector<std::string> names;

 private:
  std::map<std::string, int> numbers_;
};

struct Parsed {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<std::string> materials;  ///< of the shapes' material numbers
};

Parsed parse(const std::string& path, const std::string& text, bool triangulate) {
  Parsed parsed;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  std::istringstream stream(text);
  if (!tinyobj::LoadObj(&parsed.attributes, &parsed.shapes, &materials, &warning, &error, &stream, nullptr,
                        triangulate, false)) {
    while (!error.empty() && (error.back() == '\n' || error.back() == '\r')) error.pop_back();
    std::replace(error.begin(), error.end(), '\n', ' ');
    fail(path, error.empty() ? "not a readable OBJ file" : error);
  }
  return parsed;
}

void check_index(const std::string& path, std::size_t face, const char* what, int index, std::size_t count) {
  if (index >= 0 && static_cast<std::size_t>(index) < count) return;
  fail(path, fmt::format("face {}: {} index {} is outside the file's {}", face, what, index + 1, count));
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
  if (face == 0) fail(path, "has no faces");
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

/// Corners that agree in position, normal and uv become one vertex.
Mesh merge_corners(const Parsed& parsed) {
  const tinyobj::attrib_t& attributes = parsed.attributes;
  bool with_normals = true, with_uvs = true;
  for (const tinyobj::shape_t& shape : parsed.shapes) {
    for (const tinyobj::index_t& corner : shape.mesh.indices) {
      with_normals = with_normals && corner.normal_index >= 0;
      with_uvs = with_uvs && corner.texcoord_index >= 0;
    }
  }
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
  for (const tinyobj::shape_t& shape : parsed.shapes) {
    const std::vector<tinyobj::index_t>& corners = shape.mesh.indices;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      mesh.triangles.push_back({vertex(corners[i]), vertex(corners[i + 1]), vertex(corners[i + 2])});
    }
  }
  return mesh;
}

}  // namespace

Mesh load_obj(const std::string& path) {
  const std::optional<std::string> contents = read_text_file(path);
  if (!contents) fail(path, "cannot read the mesh file");
  const std::string& text = *contents;
  check_coordinates(path, text);
  // tinyobjloader drops faces with bad indices while it triangulates, so faces are checked as they stand in
  // the file.
  Parsed parsed = parse(path, text, false);
  if (!check_faces(path, parsed)) parsed = parse(path, text, true);
  Mesh mesh = merge_corners(parsed);
  if (mesh.triangles.empty()) fail(path, "has no faces");
  return mesh;
}

}  // namespace becalm::tracer
