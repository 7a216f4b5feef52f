#include <functional>
#include <stdexcept>

#include "tracer/materials/conductor_ior.h"
#include "tracer/scene/load/fail_in_file.h"
#include "tracer/scene/load/load_sections.h"

namespace becalm::tracer {

namespace {

std::string image_path(const JsonValue& json, const SceneDescription& scene) {
  std::string path = beside(scene.file, json.at("image").string());
  expect_file(json.at("image"), path);
  return path;
}

PicturePlacement read_placement(const JsonValue& json) {
  PicturePlacement placement;
  if (const auto v = json.find("repeat")) placement.repeat = V2f(V2d(v->numbers<2>()[0], v->numbers<2>()[1]));
  return placement;
}

TextureContent read_channel(const JsonValue& json, TextureContent otherwise) {
  const auto v = json.find("channel");
  if (!v) return otherwise;
  constexpr TextureContent channels[] = {TextureContent::r, TextureContent::g, TextureContent::b,
                                         TextureContent::a};
  return channels[v->choice({"r", "g", "b", "a"})];
}

[[noreturn]] void fail_unreadable(const JsonValue& json, const std::string& path,
                                  const std::runtime_error& error) {
  rethrow_if_of_system(error);
  json.at("image").fail(fmt::format("cannot read '{}': {}", path, error.what()));
}

std::uint32_t add_texture(const JsonValue& json, const TextureSettings& settings, SceneDescription& scene) {
  try {
    return scene.textures.add(settings);
  } catch (const std::runtime_error& error) {
    fail_unreadable(json, settings.path, error);
  }
}

std::uint32_t read_color_texture(const JsonValue& json, SceneDescription& scene) {
  json.allow_keys({"image", "space", "repeat", "scale"});
  TextureSettings settings{.path = image_path(json, scene), .placement = read_placement(json)};
  if (const auto v = json.find("space"))
    settings.space = v->choice({"srgb", "linear"}) == 0 ? ColorSpace::srgb : ColorSpace::linear;
  if (const auto v = json.find("scale")) settings.scale = read_color(*v, kLargestNumber);
  return add_texture(json, settings, scene);
}

std::uint32_t read_scalar_texture(const JsonValue& json, SceneDescription& scene) {
  json.allow_keys({"image", "channel", "repeat", "scale"});
  TextureSettings settings{.path = image_path(json, scene),
                           .placement = read_placement(json),
                           .content = read_channel(json, TextureContent::r)};
  if (const auto v = json.find("scale"))
    settings.scale = V3f(static_cast<float>(v->number(0.0, kLargestNumber)));
  return add_texture(json, settings, scene);
}

/// The members of one material.
struct Reader {
  const JsonValue& json;
  SceneDescription& scene;

  void read(std::string_view key, ColorInput& input) const {
    const auto v = json.find(key);
    if (!v) return;
    if (v->is_object()) {
      input.texture = read_color_texture(*v, scene);
    } else {
      input.value = read_color(*v, 1.0);
    }
  }
  void read(std::string_view key, ScalarInput& input) const {
    const auto v = json.find(key);
    if (!v) return;
    if (v->is_object()) {
      input.texture = read_scalar_texture(*v, scene);
    } else {
      input.value = static_cast<float>(v->number(0.0, 1.0));
    }
  }
  void read_ior(float& ior) const {
    if (const auto v = json.find("ior")) ior = static_cast<float>(v->number(0.1, 10.0));
  }
};

DiffuseMaterial read_diffuse(const Reader& reader) {
  reader.json.allow_keys({"type", "reflectance", "opacity", "bump", "normal_map"});
  DiffuseMaterial m;
  reader.json.at("reflectance");
  reader.read("reflectance", m.reflectance);
  return m;
}

ConductorMaterial read_conductor(const Reader& reader) {
  const JsonValue& json = reader.json;
  json.allow_keys({"type", "eta", "k", "reflectance", "roughness", "opacity", "bump", "normal_map"});
  ConductorMaterial m;
  if (json.has("reflectance")) {
    if (json.has("eta") || json.has("k")) json.fail("expected either reflectance, or eta and k");
    reader.read("reflectance", m.reflectance);
  } else {
    m.ior = ConductorIor{read_color(json.at("eta"), 1e4), read_color(json.at("k"), 1e4)};
  }
  reader.read("roughness", m.roughness);
  return m;
}

DielectricMaterial read_dielectric(const Reader& reader) {
  reader.json.allow_keys({"type", "ior", "roughness", "transmittance", "opacity", "bump", "normal_map"});
  DielectricMaterial m;
  reader.read_ior(m.ior);
  reader.read("roughness", m.roughness);
  reader.read("transmittance", m.transmittance);
  return m;
}

PrincipledMaterial read_principled(const Reader& reader) {
  reader.json.allow_keys({"type", "base_color", "metallic", "roughness", "ior", "anisotropy",
                          "anisotropy_rotation", "sheen", "sheen_tint", "clearcoat", "clearcoat_roughness",
                          "transmission", "opacity", "bump", "normal_map"});
  PrincipledMaterial m;
  reader.read("base_color", m.base_color);
  reader.read("metallic", m.metallic);
  reader.read("roughness", m.roughness);
  reader.read_ior(m.ior);
  reader.read("anisotropy", m.anisotropy);
  reader.read("anisotropy_rotation", m.anisotropy_rotation);
  reader.read("sheen", m.sheen);
  reader.read("sheen_tint", m.sheen_tint);
  reader.read("clearcoat", m.clearcoat);
  reader.read("clearcoat_roughness", m.clearcoat_roughness);
  reader.read("transmission", m.transmission);
  return m;
}

MixMaterial read_mix(const Reader& reader, const Names& materials) {
  const JsonValue& json = reader.json;
  json.allow_keys({"type", "materials", "factor", "opacity"});
  const std::vector<JsonValue> parts = json.at("materials").elements();
  if (parts.size() != 2) json.at("materials").fail(fmt::format("expected 2 names, found {}", parts.size()));
  MixMaterial m;
  m.first = read_reference(parts[0], materials, "material");
  m.second = read_reference(parts[1], materials, "material");
  reader.read("factor", m.factor);
  return m;
}

void read_opacity(const Reader& reader, Material& material) {
  const auto v = reader.json.find("opacity");
  if (!v) return;
  if (!v->is_object()) {
    material.opacity = static_cast<float>(v->number(0.0, 1.0));
    return;
  }
  v->allow_keys({"image", "channel", "repeat"});
  const std::string path = image_path(*v, reader.scene);
  try {
    material.opacity_mask =
        AlphaMask::read(path, read_channel(*v, TextureContent::color), read_placement(*v));
  } catch (const std::runtime_error& error) {
    fail_unreadable(*v, path, error);
  }
}

void read_relief(const Reader& reader, Material& material) {
  if (const auto v = reader.json.find("bump")) {
    v->allow_keys({"image", "channel", "repeat", "scale"});
    const TextureSettings settings{.path = image_path(*v, reader.scene),
                                   .placement = read_placement(*v),
                                   .content = read_channel(*v, TextureContent::r)};
    material.bump = BumpMap{add_texture(*v, settings, reader.scene)};
    if (const auto scale = v->find("scale")) material.bump->scale = static_cast<float>(scale->number());
  }
  if (const auto v = reader.json.find("normal_map")) {
    v->allow_keys({"image", "repeat", "strength"});
    const TextureSettings settings{.path = image_path(*v, reader.scene),
                                   .placement = read_placement(*v),
                                   .content = TextureContent::data};
    material.normal_map = NormalMap{add_texture(*v, settings, reader.scene)};
    if (const auto strength = v->find("strength"))
      material.normal_map->strength = static_cast<float>(strength->number(0.0, kLargestNumber));
  }
}

Material read_material(const std::string& name, const JsonValue& json, SceneDescription& scene,
                       const Names& materials) {
  Material material;
  material.name = name;
  const Reader reader{json, scene};
  switch (json.at("type").choice({"diffuse", "conductor", "dielectric", "principled", "mix", "interface"})) {
    case 0:
      material.model = read_diffuse(reader);
      break;
    case 1:
      material.model = read_conductor(reader);
      break;
    case 2:
      material.model = read_dielectric(reader);
      break;
    case 3:
      material.model = read_principled(reader);
      break;
    case 4:
      material.model = read_mix(reader, materials);
      break;
    case 5:
      json.allow_keys({"type"});
      material.model = DiffuseMaterial{V3f(0.0f)};
      material.is_interface = true;
      break;
  }
  if (!material.is_interface) {
    read_opacity(reader, material);
    read_relief(reader, material);
  }
  finish_material(material);
  return material;
}

/// Throws for a mix that contains itself, an interface, or a part with an opacity.
void check_mixes(const JsonValue& json, const std::vector<Material>& materials) {
  enum class State { unseen, open, done };
  std::vector<State> states(materials.size(), State::unseen);
  std::vector<int> levels(materials.size(), 0);  // mixes nested in those that are done, themselves included
  constexpr int deepest = 64;
  const auto limit = [&](std::uint32_t index, int nested) {
    if (nested > deepest)
      json.at(materials[index].name).fail(fmt::format("mixes are nested more than {} deep", deepest));
  };
  const std::function<void(std::uint32_t, int)> visit = [&](std::uint32_t index, int depth) {
    limit(index, depth);
    states[index] = State::open;
    if (const auto* mix = std::get_if<MixMaterial>(&materials[index].model)) {
      const std::vector<JsonValue> parts = json.at(materials[index].name).at("materials").elements();
      for (const std::size_t i : {0u, 1u}) {
        const std::uint32_t part = i == 0 ? mix->first : mix->second;
        const std::string& name = materials[part].name;
        if (states[part] == State::open) parts[i].fail(fmt::format("'{}' is mixed of itself", name));
        if (materials[part].is_interface)
          parts[i].fail(fmt::format("expected a material that scatters, '{}' is an interface", name));
        if (has_alpha(materials[part]))
          parts[i].fail(fmt::format("'{}' has an opacity; give it to the mix instead", name));
        if (states[part] == State::unseen) visit(part, depth + 1);
        levels[index] = std::max(levels[index], levels[part] + 1);
      }
    }
    limit(index, levels[index]);
    states[index] = State::done;
  };
  for (std::uint32_t i = 0; i < materials.size(); ++i) {
    if (states[i] == State::unseen) visit(i, 0);
  }
}

}  // namespace

Names read_materials(const JsonValue& json, SceneDescription& scene) {
  const auto members = json.members();
  Names names;  // all of them first: a mix may name what stands after it
  for (const auto& [name, value] : members) {
    names.emplace(name, static_cast<std::uint32_t>(names.size()));
  }
  for (const auto& [name, value] : members) {
    scene.materials.push_back(read_material(name, value, scene, names));
  }
  check_mixes(json, scene.materials);
  return names;
}

}  // namespace becalm::tracer
