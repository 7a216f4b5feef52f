#include <stdexcept>

#include "tracer/materials/conductor_ior.h"
#include "tracer/scene/load_sections.h"

namespace becalm::tracer {

namespace {

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
  if (const auto v = json.find("scale")) settings.scale = read_color(*v, kLargestNumber);
  expect_file(json.at("image"), settings.path);
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

}  // namespace

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

}  // namespace becalm::tracer
