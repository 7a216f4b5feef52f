#include <tbb/parallel_for.h>

#include <algorithm>
#include <exception>
#include <iterator>

#include "tracer/scene/load/load_procedural.h"
#include "tracer/scene/load/load_sections.h"
#include "tracer/scene/load/mtl.h"
#include "tracer/scene/load/obj.h"
#include "tracer/scene/shapes.h"

namespace becalm::tracer {

namespace {

/// One entry of the section: a geometry, or the parts of an OBJ file that brings its own materials.
struct LoadedMesh {
  Geometry geometry;
  std::optional<ObjParts> parts;
  std::string path;
};

Geometry read_shape(const JsonValue& json) {
  json.allow_keys({"shape", "segments"});
  const int segments = json.has("segments") ? json.at("segments").integer(3, 4096) : 64;
  const int shape = json.at("shape").choice({"rectangle", "disc", "sphere", "cube", "exact_sphere"});
  if (json.has("segments") && shape != 1 && shape != 2)
    json.at("segments").fail("only a disc and a sphere have segments");
  switch (shape) {
    case 0:
      return make_rectangle();
    case 1:
      return make_disc(segments);
    case 2:
      return make_sphere(segments);
    case 3:
      return make_cube();
    default:
      return UnitSphere{};
  }
}

LoadedMesh read_mesh(const JsonValue& json, const std::string& scene_file) {
  if (json.has("procedural")) return {read_procedural(json), std::nullopt, ""};
  if (!json.has("obj")) return {read_shape(json), std::nullopt, ""};
  json.allow_keys({"obj", "materials"});
  const std::string path = beside(scene_file, json.at("obj").string());
  expect_file(json.at("obj"), path);
  // "mtl" is the only choice; without it the OBJ file's materials are ignored.
  if (const auto materials = json.find("materials")) {
    materials->choice({"mtl"});
    return {Mesh(), load_obj_parts(path), path};
  }
  return {load_obj(path), std::nullopt, path};
}

/// The entries in their order. Reads as many files at a time as there are threads; of several errors the
/// first entry's is thrown.
std::vector<LoadedMesh> read_all(const std::vector<std::pair<std::string, JsonValue>>& entries,
                                 const std::string& scene_file) {
  std::vector<LoadedMesh> loaded(entries.size());
  std::vector<std::exception_ptr> errors(entries.size());
  tbb::parallel_for(std::size_t{0}, entries.size(), [&](std::size_t i) {
    try {
      loaded[i] = read_mesh(entries[i].second, scene_file);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  return loaded;
}

}  // namespace

void read_meshes(const JsonValue& json, SceneNames& names, SceneDescription& scene) {
  const std::vector<std::pair<std::string, JsonValue>> entries = json.members();
  std::vector<LoadedMesh> loaded = read_all(entries, scene.file);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    LoadedMesh& mesh = loaded[i];
    names.meshes.emplace(entries[i].first, static_cast<std::uint32_t>(scene.meshes.size()));
    if (!mesh.parts) {
      scene.meshes.push_back(std::move(mesh.geometry));
      continue;
    }
    std::vector<MeshPart>& parts = names.parts[static_cast<std::uint32_t>(scene.meshes.size())];
    std::vector<std::string> warnings;
    std::vector<MtlMaterial> materials =
        load_part_materials(mesh.path, *mesh.parts, scene.textures, warnings);
    // Meshes may name one library.
    std::ranges::copy_if(warnings, std::back_inserter(scene.warnings), [&](const std::string& warning) {
      return std::ranges::find(scene.warnings, warning) == scene.warnings.end();
    });
    for (std::size_t part = 0; part < materials.size(); ++part) {
      // An image cannot mask a mesh without uvs.
      if (mesh.parts->parts[part].mesh.uvs.empty()) materials[part].material.opacity_mask.reset();
      parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()),
                       static_cast<std::uint32_t>(scene.materials.size()), materials[part].emission});
      scene.meshes.push_back(std::move(mesh.parts->parts[part].mesh));
      scene.materials.push_back(std::move(materials[part].material));
    }
  }
}

}  // namespace becalm::tracer
