// Materials of a scene file: textured parameters, mixes, interfaces, opacity.
#include "tracer/scene/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/materials/conductor_ior.h"

namespace becalm::tracer::test {
namespace {

std::string scene_text(const std::string& materials) {
  return "{'camera': {'look_at': {'eye': [0,0,5], 'target': [0,0,0]}}, 'materials': {" + materials +
         "}, 'meshes': {}, 'objects': []}";
}
std::string material_error(const std::string& materials) {
  return load_error(scene_text(materials));
}

const Material& named(const Scene& scene, const std::string& name) {
  for (const Material& material : scene.description().materials) {
    if (material.name == name) return material;
  }
  throw std::runtime_error("no material " + name);
}

template <class Model>
Model evaluate(const Scene& scene, const std::string& name, const V2f& uv) {
  const Textures::Reader reader(scene.description().textures);
  return std::get<Model>(evaluate_material(named(scene, name), reader, {uv}));
}

TEST(Material, EveryParameterMayBeAnImage) {
  // Two texels side by side, r g b: parameters differ by channel and place.
  write_image("p.exr", 2, 1, 3, {0.25f, 0.5f, 0.75f, 1.0f, 0.0f, 0.125f});
  const Scene scene = load_text(scene_text(R"(
    'm': {'type': 'conductor', 'reflectance': {'image': 'p.exr', 'space': 'linear'}, 'roughness': {'image': 'p.exr', 'channel': 'g'}},
    'g': {'type': 'dielectric', 'roughness': {'image': 'p.exr'}, 'transmittance': {'image': 'p.exr', 'space': 'linear'}},
    'p': {'type': 'principled', 'base_color': {'image': 'p.exr', 'space': 'linear'}, 'metallic': {'image': 'p.exr', 'channel': 'r'},
          'roughness': {'image': 'p.exr', 'channel': 'g', 'scale': 0.5}, 'clearcoat': {'image': 'p.exr', 'channel': 'b'}, 'sheen': 0.25},
    'c': {'type': 'diffuse', 'reflectance': 0.5})"));
  EXPECT_FALSE(named(scene, "c").textured);
  for (const char* name : {"m", "g", "p"}) EXPECT_TRUE(named(scene, name).textured) << name;
  const V2f left(0.25f, 0.5f), right(0.75f, 0.5f);

  const auto metal = evaluate<ConductorBsdf>(scene, "m", left);
  EXPECT_NEAR((metal.k - conductor_from_reflectance(V3f(0.25f, 0.5f, 0.75f)).k).length(), 0.0f, 0.01f);
  EXPECT_NEAR(metal.alpha, roughness_to_alpha(0.5f), 1e-6f);
  EXPECT_EQ(evaluate<ConductorBsdf>(scene, "m", right).alpha, 0.0f);
  const auto glass = evaluate<DielectricBsdf>(scene, "g", left);
  EXPECT_NEAR(glass.alpha, roughness_to_alpha(0.25f), 1e-6f);
  EXPECT_NEAR(glass.transmittance.z, 0.75f, 1e-3f);

  constexpr float kTextureStep = 2e-5f;  // texels are 16-bit steps
  const auto left_p = evaluate<PrincipledBsdf>(scene, "p", left);
  const PrincipledBsdf expected = make_principled({.base_color = V3f(0.25f, 0.5f, 0.75f),
                                                   .metallic = 0.25f,
                                                   .roughness = 0.25f,
                                                   .sheen = 0.25f,
                                                   .clearcoat = 0.75f});
  EXPECT_NEAR((left_p.base_color - expected.base_color).length(), 0.0f, kTextureStep);
  EXPECT_NEAR(left_p.metal, expected.metal, kTextureStep);
  EXPECT_NEAR(left_p.alpha, expected.alpha, kTextureStep);
  EXPECT_NEAR(left_p.coat, expected.coat, kTextureStep);
  EXPECT_EQ(left_p.sheen, expected.sheen);
  EXPECT_EQ(evaluate<PrincipledBsdf>(scene, "p", right).metal, 1.0f);
}

TEST(Material, MixesFindEachPartWithItsShare) {
  // 'a' stands before its parts in the file's order of names, and is nested: a third each of red, green,
  // blue.
  const Scene scene = load_text(scene_text(R"(
    'a': {'type': 'mix', 'materials': ['red', 'b'], 'factor': 0.6666667},
    'b': {'type': 'mix', 'materials': ['green', 'blue'], 'factor': 0.5},
    'blue': {'type': 'diffuse', 'reflectance': [0,0,1]},
    'green': {'type': 'diffuse', 'reflectance': [0,1,0]},
    'red': {'type': 'diffuse', 'reflectance': [1,0,0]})"));
  const std::vector<Material>& materials = scene.description().materials;
  const Textures::Reader reader(scene.description().textures);
  constexpr int count = 3000;
  std::map<std::string, int> found;
  for (int i = 0; i < count; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / count;
    ++found[resolve_mix(materials, named(scene, "a"), reader, {}, u).name];
  }
  for (const char* name : {"red", "green", "blue"}) EXPECT_NEAR(found[name], count / 3.0, 2.0) << name;
  EXPECT_EQ(&resolve_mix(materials, named(scene, "red"), reader, {}, 0.7f), &named(scene, "red"));
  const MaterialNeeds needs = material_needs(materials, named(scene, "a"));
  EXPECT_TRUE(needs.mix);
  EXPECT_FALSE(needs.textures || needs.specular || needs.transmission);
}

TEST(Material, MixesByImageAndAtTheEnds) {
  write_image("f.exr", 2, 1, 1, {0.0f, 1.0f});
  const Scene scene = load_text(scene_text(R"(
    'm': {'type': 'mix', 'materials': ['x', 'y'], 'factor': {'image': 'f.exr'}},
    'x': {'type': 'diffuse', 'reflectance': 0.5}, 'y': {'type': 'conductor', 'reflectance': 1})"));
  const std::vector<Material>& materials = scene.description().materials;
  const Textures::Reader reader(scene.description().textures);
  for (const float start : {0.0f, 0.5f, 0x1.fffffep-1f}) {
    for (const auto& [place, name] : {std::pair(0.25f, "x"), std::pair(0.75f, "y")}) {
      EXPECT_EQ(resolve_mix(materials, named(scene, "m"), reader, {{place, 0.5f}}, start).name, name);
    }
  }
  const MaterialNeeds needs = material_needs(materials, named(scene, "m"));
  EXPECT_TRUE(needs.mix && needs.textures && needs.specular && needs.delta_lobes);
  EXPECT_FALSE(needs.rough_specular);
}

TEST(Material, NeedsFollowTheParameters) {
  const Scene scene = load_text(scene_text(R"(
    'brushed': {'type': 'principled', 'metallic': 1, 'anisotropy': 0.5},
    'chrome': {'type': 'principled', 'metallic': 1, 'roughness': 0},
    'window': {'type': 'principled', 'transmission': 0.5},
    'fog': {'type': 'interface'}, 'veil': {'type': 'diffuse', 'reflectance': 1, 'opacity': 0.5})"));
  const auto needs = [&](const char* name) {
    return material_needs(scene.description().materials, named(scene, name));
  };
  EXPECT_TRUE(needs("brushed").tangents && needs("brushed").rough_specular);
  EXPECT_FALSE(needs("brushed").transmission || needs("brushed").specular);
  EXPECT_TRUE(needs("chrome").specular);
  EXPECT_FALSE(needs("chrome").tangents);
  EXPECT_TRUE(needs("window").transmission);
  EXPECT_TRUE(needs("fog").interface && needs("fog").transmission);
  EXPECT_TRUE(named(scene, "fog").is_interface);
  EXPECT_TRUE(needs("veil").alpha);
  EXPECT_FALSE(needs("chrome").alpha || needs("veil").interface);
  EXPECT_EQ(opacity(named(scene, "veil"), V2f(0.3f)), 0.5f);
}

TEST(Material, OpacityIsTheAlphaChannelOrTheLuminance) {
  write_image("rgba.exr", 2, 1, 4, {1, 1, 1, 0.0f, 1, 1, 1, 1.0f});
  write_image("rgb.exr", 1, 1, 3, {0.0f, 1.0f, 0.0f});
  write_image("odd.exr", 1, 1, 1, {std::numeric_limits<float>::quiet_NaN()});
  const Scene scene = load_text(scene_text(R"(
    'leaf': {'type': 'diffuse', 'reflectance': 1, 'opacity': {'image': 'rgba.exr', 'repeat': [2, 1]}},
    'lum': {'type': 'diffuse', 'reflectance': 1, 'opacity': {'image': 'rgb.exr'}},
    'red': {'type': 'diffuse', 'reflectance': 1, 'opacity': {'image': 'rgb.exr', 'channel': 'r'}},
    'odd': {'type': 'diffuse', 'reflectance': 1, 'opacity': {'image': 'odd.exr'}})"));
  const Material& leaf = named(scene, "leaf");
  EXPECT_TRUE(has_alpha(leaf));
  EXPECT_EQ(opacity(leaf, {0.125f, 0.5f}), 0.0f);
  EXPECT_EQ(opacity(leaf, {0.375f, 0.5f}), 1.0f);
  EXPECT_EQ(opacity(leaf, {-0.625f, 7.5f}), 1.0f) << "repeats";
  EXPECT_NEAR(opacity(leaf, {0.25f, 0.0f}), 0.5f, 1e-5f) << "between texels";
  EXPECT_NEAR(opacity(leaf, {0.0f, 0.0f}), 0.5f, 1e-5f) << "across the seam";
  EXPECT_NEAR(opacity(named(scene, "lum"), {0.5f, 0.5f}), 0.7152f, 0.5f / 255.0f);
  EXPECT_EQ(opacity(named(scene, "red"), {0.5f, 0.5f}), 0.0f);
  EXPECT_EQ(opacity(named(scene, "odd"), {0.5f, 0.5f}), 0.0f) << "NaN is 0";
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30f}) {
    const float value = opacity(leaf, V2f(bad));
    EXPECT_TRUE(value >= 0.0f && value <= 1.0f) << bad;
  }
}

TEST(Material, VRunsUpInOpacityMasks) {
  write_image("v.exr", 1, 2, 1, {1.0f, 0.0f});
  const AlphaMask mask = AlphaMask::read(file_path("v.exr"), TextureContent::color, {});
  EXPECT_EQ(mask.opacity({0.5f, 0.75f}), 1.0f);
  EXPECT_EQ(mask.opacity({0.5f, 0.25f}), 0.0f);
}

TEST(Material, Errors) {
  const std::string white = "'w': {'type': 'diffuse', 'reflectance': 1}";
  EXPECT_EQ(
      material_error(
          "'a': {'type': 'mix', 'materials': ['b', 'w']}, 'b': {'type': 'mix', 'materials': ['w', 'a']}, " +
          white),
      "scene.json: /materials/b/materials/1: 'a' is mixed of itself");
  EXPECT_EQ(material_error("'a': {'type': 'mix', 'materials': ['a', 'w']}, " + white),
            "scene.json: /materials/a/materials/0: 'a' is mixed of itself");
  EXPECT_EQ(material_error("'a': {'type': 'mix', 'materials': ['w', 'x']}, " + white),
            "scene.json: /materials/a/materials/1: no material 'x'");
  EXPECT_EQ(material_error("'a': {'type': 'mix', 'materials': ['w']}, " + white),
            "scene.json: /materials/a/materials: expected 2 names, found 1");
  EXPECT_EQ(
      material_error("'a': {'type': 'mix', 'materials': ['w', 'v']}, 'v': {'type': 'interface'}, " + white),
      "scene.json: /materials/a/materials/1: expected a material that scatters, 'v' is an interface");
  EXPECT_EQ(material_error("'a': {'type': 'mix', 'materials': ['w', 'v']}, 'v': {'type': 'diffuse', "
                           "'reflectance': 1, 'opacity': 0.5}, " +
                           white),
            "scene.json: /materials/a/materials/1: 'v' has an opacity; give it to the mix instead");
  EXPECT_EQ(material_error("'a': {'type': 'principled', 'roughness': 2}"),
            "scene.json: /materials/a/roughness: expected a number from 0 to 1, found 2");
  EXPECT_EQ(material_error("'a': {'type': 'diffuse'}"), "scene.json: /materials/a: 'reflectance' is missing");
  EXPECT_EQ(material_error("'a': {'type': 'diffuse', 'reflectance': 1, 'opacity': {'image': 'no.png'}}"),
            "scene.json: /materials/a/opacity/image: no file 'no.png'");
  write_image("grey.exr", 1, 1, 1, {1.0f});
  for (const char* use : {"'opacity': {'image': 'grey.exr', 'channel': 'a'}",
                          "'bump': {'image': 'grey.exr', 'channel': 'a'}"}) {
    EXPECT_NE(material_error(std::string("'a': {'type': 'diffuse', 'reflectance': 1, ") + use + "}")
                  .find("it has no channel 'a'"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace becalm::tracer::test
