#include "tracer/scene/load.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "frame/error.h"
#include "tracer/materials/conductor_ior.h"
#include "tracer/scene/json_reader.h"
#include "tracer/scene/obj.h"
#include "tracer/scene/shapes.h"

namespace becalm::tracer {

namespace {

constexpr double kLargest = std::numeric_limits<float>::max();

V3f to_v3f(const std::array<double, 3>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

V3f read_color(const JsonValue& json, double high) {
  return to_v3f(json.triple(0.0, high));
}

std::string beside(const std::string& scene_file, const std::string& path) {
  return (std::filesystem::path(scene_file).parent_path() / path).string();
}

/// {"interpolation": ..., "keys": [{"frame": ..., ...}, ...]}, each key's values read by `read_value`.
template <std::size_t N, class ReadValue>
Curve<N> read_keys(const JsonValue& json, const ReadValue& read_value) {
  json.allow_keys({"interpolation", "keys"});
  Interpolation interpolation = Interpolation::linear;
  if (const auto value = json.find("interpolation")) {
    interpolation = static_cast<Interpolation>(value->choice({"linear", "smooth"}));
  }
  std::vector<typename Curve<N>::Key> keys;
  for (const JsonValue& element : json.at("keys").elements()) {
    const typename Curve<N>::Key key{element.at("frame").number(), read_value(element)};
    if (!keys.empty() && key.frame <= keys.back().frame) {
      element.at("frame").fail(
          fmt::format("expected a frame after the key before, {}, found {}", keys.back().frame, key.frame));
    }
    keys.push_back(key);
  }
  if (keys.empty()) json.at("keys").fail("expected at least one key");
  return {std::move(keys), interpolation};
}

TransformCurve::Value read_transform_value(const JsonValue& json) {
  TransformCurve::Value value{0, 0, 0, 0, 0, 0, 1, 1, 1};
  const auto store = [&](const std::array<double, 3>& v, std::size_t first) {
    std::copy(v.begin(), v.end(), value.begin() + first);
  };
  if (const auto v = json.find("translate")) store(v->numbers<3>(), 0);
  if (const auto v = json.find("rotate_deg")) store(v->numbers<3>(), 3);
  if (const auto v = json.find("scale")) {
    store(v->triple(-kLargest, kLargest), 6);
    for (std::size_t i = 6; i < 9; ++i) {
      if (value[i] == 0.0) v->fail("a scale must not be 0");
    }
  }
  return value;
}

TransformCurve read_transform(const JsonValue& json) {
  if (!json.has("keys")) {
    json.allow_keys({"translate", "rotate_deg", "scale"});
    return read_transform_value(json);
  }
  TransformCurve curve = read_keys<9>(json, [](const JsonValue& key) {
    key.allow_keys({"frame", "translate", "rotate_deg", "scale"});
    return read_transform_value(key);
  });
  for (const TransformCurve::Key& key : curve.keys()) {
    for (std::size_t i = 6; i < 9; ++i) {
      if (key.value[i] * curve.keys().front().value[i] < 0.0) {
        json.at("keys").fail("a scale must not change its sign between keys: it would pass through 0");
      }
    }
  }
  return curve;
}

LookAtCurve::Value read_look_at_value(const JsonValue& json) {
  LookAtCurve::Value value;
  const auto eye = json.at("eye").numbers<3>();
  const auto target = json.at("target").numbers<3>();
  const auto up = json.has("up") ? json.at("up").numbers<3>() : std::array<double, 3>{0, 1, 0};
  std::copy(eye.begin(), eye.end(), value.begin());
  std::copy(target.begin(), target.end(), value.begin() + 3);
  std::copy(up.begin(), up.end(), value.begin() + 6);
  if (!is_valid(look_at(value, 0.0)))
    json.fail("eye and target must differ, and up must not point along the view");
  return value;
}

CameraSettings read_camera(const JsonValue& json) {
  json.allow_keys({"fov_y_deg", "look_at"});
  CameraSettings camera;
  if (const auto fov = json.find("fov_y_deg")) camera.fov_y_deg = fov->number(0.01, 179.0);
  const JsonValue view = json.at("look_at");
  if (view.has("keys")) {
    camera.look_at = read_keys<9>(view, [](const JsonValue& key) {
      key.allow_keys({"frame", "eye", "target", "up"});
      return read_look_at_value(key);
    });
  } else {
    view.allow_keys({"eye", "target", "up"});
    camera.look_at = read_look_at_value(view);
  }
  return camera;
}

FrameRange read_frames(const JsonValue& json) {
  json.allow_keys({"first", "last", "rate"});
  constexpr int furthest = 1'000'000'000;
  FrameRange frames;
  frames.first = json.at("first").integer(-furthest, furthest);
  frames.last = json.at("last").integer(frames.first, furthest);
  if (const auto rate = json.find("rate")) frames.rate = rate->number(1e-3, 1e6);
  return frames;
}

Film read_film(const JsonValue& json) {
  json.allow_keys({"width", "height", "filter"});
  constexpr int largest_size = 65536;
  Film film;
  film.width = json.at("width").integer(1, largest_size);
  film.height = json.at("height").integer(1, largest_size);
  if (const auto filter = json.find("filter")) {
    filter->allow_keys({"type", "radius_px"});
    film.filter.type = static_cast<FilterType>(filter->at("type").choice({"blackman_harris", "box", "tent"}));
    if (const auto radius = filter->find("radius_px")) film.filter.radius_px = radius->number(0.0, 32.0);
  }
  return film;
}

Integrator read_integrator(const JsonValue& json) {
  json.allow_keys({"max_depth", "roulette_depth", "direct", "heuristic"});
  Integrator integrator;
  if (const auto v = json.find("max_depth")) integrator.max_depth = v->integer(0, 100'000);
  if (const auto v = json.find("roulette_depth")) integrator.roulette_depth = v->integer(0, 100'000);
  if (const auto v = json.find("direct"))
    integrator.direct = static_cast<Direct>(v->choice({"mis", "light", "material"}));
  if (const auto v = json.find("heuristic")) {
    integrator.heuristic = static_cast<Heuristic>(v->choice({"power", "balance"}));
  }
  return integrator;
}

/// The image as floats. Throws an error at the JSON value that names it.
Image read_image(const JsonValue& json, const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) json.fail(fmt::format("no file '{}'", path));
  const auto file = OIIO::ImageInput::open(path);
  if (!file) json.fail(fmt::format("cannot read '{}': {}", path, OIIO::geterror()));
  const OIIO::ImageSpec& spec = file->spec();
  Image image(spec.width, spec.height, spec.nchannels);
  if (!file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, image.data().data())) {
    json.fail(fmt::format("cannot read '{}': {}", path, file->geterror()));
  }
  return image;
}

void read_environment(const JsonValue& json, SceneDescription& scene) {
  if (json.has("image")) {
    json.allow_keys({"image", "scale", "rotate_y_deg"});
    const JsonValue image = json.at("image");
    const double scale = json.has("scale") ? json.at("scale").number(0.0, kLargest) : 1.0;
    const double rotation = json.has("rotate_y_deg") ? json.at("rotate_y_deg").number() : 0.0;
    scene.environment = Environment::image(read_image(image, beside(scene.file, image.string())),
                                           static_cast<float>(scale), static_cast<float>(rotation));
    scene.environment_is_image = true;
  } else {
    json.allow_keys({"radiance"});
    scene.environment = Environment::constant(read_color(json.at("radiance"), kLargest));
  }
}

std::uint32_t read_texture(const JsonValue& json, SceneDescription& scene) {
  json.allow_keys({"image", "space", "repeat", "scale"});
  TextureSettings settings;
  settings.path = beside(scene.file, json.at("image").string());
  if (const auto v = json.find("space"))
    settings.space = v->choice({"srgb", "linear"}) == 0 ? ColorSpace::srgb : ColorSpace::linear;
  if (const auto v = json.find("repeat")) {
    const auto repeat = v->numbers<2>();
    settings.repeat = {static_cast<float>(repeat[0]), static_cast<float>(repeat[1])};
  }
  if (const auto v = json.find("scale")) settings.scale = read_color(*v, kLargest);
  if (!std::filesystem::is_regular_file(settings.path)) {
    json.at("image").fail(fmt::format("no file '{}'", settings.path));
  }
  try {
    return scene.textures.add(settings);
  } catch (const std::runtime_error& error) {
    json.at("image").fail(fmt::format("cannot read '{}': {}", settings.path, error.what()));
  }
}

float read_alpha(const JsonValue& json) {
  const auto roughness = json.find("roughness");
  return roughness ? roughness_to_alpha(static_cast<float>(roughness->number(0.0, 1.0))) : 0.0f;
}

Material read_material(const std::string& name, const JsonValue& json, SceneDescription& scene) {
  Material material;
  material.name = name;
  switch (json.at("type").choice({"diffuse", "conductor", "dielectric"})) {
    case 0: {
      json.allow_keys({"type", "reflectance"});
      const JsonValue reflectance = json.at("reflectance");
      if (reflectance.is_object()) {
        material.texture = read_texture(reflectance, scene);
        material.bsdf = DiffuseBsdf{V3f(0.5f)};
      } else {
        material.bsdf = DiffuseBsdf{read_color(reflectance, 1.0)};
      }
      break;
    }
    case 1: {
      json.allow_keys({"type", "eta", "k", "reflectance", "roughness"});
      ConductorIor ior;
      if (json.has("reflectance")) {
        if (json.has("eta") || json.has("k")) json.fail("expected either reflectance, or eta and k");
        ior = conductor_from_reflectance(read_color(json.at("reflectance"), 1.0));
      } else {
        ior = {read_color(json.at("eta"), 1e4), read_color(json.at("k"), 1e4)};
      }
      material.bsdf = ConductorBsdf{ior.eta, ior.k, read_alpha(json)};
      break;
    }
    case 2: {
      json.allow_keys({"type", "ior", "roughness", "transmittance"});
      DielectricBsdf dielectric{1.5f, read_alpha(json), V3f(1.0f)};
      if (const auto v = json.find("ior")) dielectric.eta = static_cast<float>(v->number(0.1, 10.0));
      if (const auto v = json.find("transmittance")) dielectric.transmittance = read_color(*v, 1.0);
      material.bsdf = dielectric;
      break;
    }
  }
  return material;
}

Mesh read_mesh(const JsonValue& json, const std::string& scene_file) {
  if (json.has("obj")) {
    json.allow_keys({"obj"});
    const std::string path = beside(scene_file, json.at("obj").string());
    if (!std::filesystem::is_regular_file(path)) json.at("obj").fail(fmt::format("no file '{}'", path));
    return load_obj(path);
  }
  json.allow_keys({"shape", "segments"});
  const int segments = json.has("segments") ? json.at("segments").integer(3, 4096) : 64;
  switch (json.at("shape").choice({"rectangle", "disc", "sphere", "cube"})) {
    case 0:
      return make_rectangle();
    case 1:
      return make_disc(segments);
    case 2:
      return make_sphere(segments);
    default:
      return make_cube();
  }
}

using Names = std::map<std::string, std::uint32_t, std::less<>>;

std::uint32_t read_reference(const JsonValue& json, const Names& names, const char* what) {
  const std::string name = json.string();
  const auto found = names.find(name);
  if (found == names.end()) json.fail(fmt::format("no {} '{}'", what, name));
  return found->second;
}

Curve<3> read_emission(const JsonValue& json) {
  if (!json.is_object()) return json.triple(0.0, kLargest);
  return read_keys<3>(json, [](const JsonValue& key) {
    key.allow_keys({"frame", "value"});
    return key.at("value").triple(0.0, kLargest);
  });
}

Object read_object(const JsonValue& json, const Names& meshes, const Names& materials) {
  json.allow_keys({"name", "mesh", "material", "emission", "two_sided", "transform"});
  Object object;
  if (const auto name = json.find("name")) object.name = name->string();
  object.mesh = read_reference(json.at("mesh"), meshes, "mesh");
  object.material = read_reference(json.at("material"), materials, "material");
  if (const auto emission = json.find("emission")) object.emission = read_emission(*emission);
  for (const Curve<3>::Key& key : object.emission.keys()) {
    object.emissive = object.emissive || key.value != Curve<3>::Value{0, 0, 0};
  }
  if (const auto two_sided = json.find("two_sided")) object.two_sided = two_sided->boolean();
  if (const auto transform = json.find("transform")) object.transform = read_transform(*transform);
  return object;
}

}  // namespace

Scene load_scene(const std::string& file) {
  const nlohmann::json document = parse_json_file(file);
  const JsonValue json(document, file, "");
  json.allow_keys(
      {"frames", "film", "integrator", "camera", "environment", "materials", "meshes", "objects"});

  SceneDescription scene;
  scene.file = file;
  if (const auto v = json.find("frames")) scene.frames = read_frames(*v);
  if (const auto v = json.find("film")) scene.film = read_film(*v);
  if (const auto v = json.find("integrator")) scene.integrator = read_integrator(*v);
  scene.camera = read_camera(json.at("camera"));
  if (const auto v = json.find("environment")) read_environment(*v, scene);

  Names materials, meshes;
  for (const auto& [name, value] : json.at("materials").members()) {
    materials.emplace(name, static_cast<std::uint32_t>(scene.materials.size()));
    scene.materials.push_back(read_material(name, value, scene));
  }
  for (const auto& [name, value] : json.at("meshes").members()) {
    meshes.emplace(name, static_cast<std::uint32_t>(scene.meshes.size()));
    scene.meshes.push_back(read_mesh(value, file));
  }
  for (const JsonValue& value : json.at("objects").elements()) {
    scene.objects.push_back(read_object(value, meshes, materials));
  }
  return Scene(std::move(scene));
}

}  // namespace becalm::tracer
