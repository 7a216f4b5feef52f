#include "tracer/scene/load/load.h"

#include <nlohmann/json.hpp>
#include <set>

#include "tracer/scene/load/load_media.h"
#include "tracer/scene/load/load_sections.h"

namespace becalm::tracer {

namespace {

/// What exceeds it is read on demand.
constexpr std::size_t kResidentTextureBytes = std::size_t{1} << 30;

}  // namespace

Scene load_scene(const std::string& file) {
  const nlohmann::json document = parse_json_file(file);
  const JsonValue json(document, file, "");
  json.allow_keys({"frames", "film", "integrator", "camera", "environment", "lights", "materials", "media",
                   "meshes", "objects"});

  SceneDescription scene;
  scene.file = file;
  if (const auto v = json.find("frames")) scene.frames = read_frames(*v);
  if (const auto v = json.find("film")) scene.film = read_film(*v);
  if (const auto v = json.find("integrator")) scene.integrator = read_integrator(*v);
  scene.camera = read_camera(json.at("camera"));
  if (const auto v = json.find("environment")) read_environment(*v, scene);
  if (const auto v = json.find("lights")) read_lights(*v, scene);

  SceneNames names;
  if (const auto v = json.find("materials")) names.materials = read_materials(*v, scene);
  if (const auto media = json.find("media")) {
    for (const auto& [name, value] : media->members()) {
      names.media.emplace(name, static_cast<std::uint32_t>(scene.media.size()));
      scene.media.push_back(read_medium(value));
    }
  }
  read_meshes(json.at("meshes"), names, scene);
  for (const JsonValue& value : json.at("objects").elements()) read_object(value, names, scene);
  std::set<std::uint32_t> used;
  for (const Object& object : scene.objects) used.insert(object.material);
  scene.textures.make_resident(textures_of(scene.materials, std::move(used)), kResidentTextureBytes);
  return Scene(std::move(scene));
}

}  // namespace becalm::tracer
