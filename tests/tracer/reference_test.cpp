// Small renders against long ones made by another estimator: no block of pixels may tell them apart.
#include <gtest/gtest.h>

#include "tests/tracer/estimates.h"
#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

constexpr int kBlock = 3;

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

/// The scene as it renders by default at 4 spp, against the scene with INTEGRATOR replaced by the estimator
/// of the reference and other seeds, with `more` times the samples.
void expect_reference(const std::string& name, const std::string& json, const std::string& integrator,
                      int frame = 1, int more = 4, int seeds = 20) {
  expect_same_expectation(
      {name, replaced(json, "INTEGRATOR", "'max_depth': 4"), 4, seeds, 1, frame},
      {name + " by " + integrator, replaced(json, "INTEGRATOR", "'max_depth': 4, " + integrator), 4 * more,
       seeds, 90001, frame},
      kBlock, 0.05);
}

std::string stage(const std::string& camera, const std::string& sections, const std::string& objects) {
  return R"({'film': {'width': 24, 'height': 15}, 'integrator': {INTEGRATOR},
    'camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,1.8,5], 'target': [0,0.8,0]})" +
         camera + R"(},
    'meshes': {'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}, 'ball': {'shape': 'exact_sphere'}, 'pebble': {'shape': 'sphere', 'segments': 128},
      'drops': {'procedural': 'blobs', 'count': 6, 'extent': 0.7, 'seed': 5}, 'sea': {'procedural': 'ocean', 'size': 8, 'wavelength': 2, 'wave_height': 0.3, 'trains': 16}},
    )" + sections +
         R"(, 'objects': [{'name': 'floor', 'mesh': 'plane', 'material': 'white', 'transform': {'scale': 4}}, )" +
         objects + "]}";
}

const std::string kMaterials =
    R"('materials': {'white': {'type': 'diffuse', 'reflectance': [0.8,0.6,0.4]}, 'gloss': {'type': 'principled', 'base_color': [0.7,0.3,0.2], 'roughness': 0.5, 'clearcoat': 0.5, 'sheen': 0.5},
      'metal': {'type': 'conductor', 'reflectance': [0.9,0.7,0.5], 'roughness': 0.5}, 'glass': {'type': 'dielectric', 'ior': 1.4, 'roughness': 0.6},
      'blend': {'type': 'mix', 'materials': ['gloss', 'metal'], 'factor': 0.5}, 'veil': {'type': 'diffuse', 'reflectance': 0.5, 'opacity': 0.6}, 'air': {'type': 'interface'}})";
const std::string kPanel =
    "{'mesh': 'plane', 'material': 'white', 'emission': [6,5,4], 'transform': {'scale': [1.2,1,0.8], "
    "'rotate_deg': [160,0,0], 'translate': [0,3.2,0.8]}}";

TEST(Reference, MotionBlurAndDepthOfField) {
  expect_reference("motion blur and depth of field",
                   stage(", 'shutter': [0,1], 'aperture_radius': 0.2, 'blades': 5", kMaterials, kPanel + R"(,
      {'mesh': 'cube', 'material': 'metal', 'transform': {'keys': [{'frame': 1, 'scale': 0.5, 'translate': [-1.2,0.6,0]}, {'frame': 2, 'scale': 0.5, 'rotate_deg': [0,140,0], 'translate': [0.6,0.9,0.5]}]}},
      {'mesh': 'ball', 'material': 'white', 'emission': [1,2,5], 'transform': {'keys': [{'frame': 1, 'scale': 0.4, 'translate': [1.5,0.5,-1]}, {'frame': 2, 'scale': 0.4, 'translate': [1.2,1.4,0]}]}})"),
                   "'direct': 'material'");
}

TEST(Reference, FogAndCloud) {
  expect_reference(
      "fog and cloud",
      stage(
          "", kMaterials + R"(, 'environment': {'radiance': [0.2,0.3,0.5]},
      'media': {'fog': {'type': 'homogeneous', 'extinction': [0.4,0.6,0.9], 'albedo': 0.8, 'g': 0.3}, 'cloud': {'type': 'cloud', 'extinction': 8, 'albedo': 0.9, 'resolution': [16,16,16], 'frequency': 2, 'seed': 3}})",
          kPanel +
              R"(, {'mesh': 'cube', 'material': 'air', 'interior': 'fog', 'transform': {'scale': [1.2,0.8,1], 'translate': [-1,0.9,0]}},
      {'mesh': 'cube', 'material': 'air', 'interior': 'cloud', 'transform': {'scale': 0.7, 'rotate_deg': [0,30,0], 'translate': [1.2,1,0]}},
      {'mesh': 'ball', 'material': 'glass', 'interior': 'fog', 'transform': {'scale': 0.4, 'translate': [0,0.5,1.4]}})"),
      "'direct': 'material'");
}

TEST(Reference, InstancesAndOpacity) {
  expect_reference("instances and opacity",
                   stage("", kMaterials + ", 'environment': {'radiance': [0.3,0.4,0.6]}", kPanel + R"(,
      {'mesh': 'pebble', 'material': 'blend', 'transform': {'scale': 0.25}, 'scatter': {'count': 9, 'seed': 2, 'area': [-2,-1,2,2], 'on': 'floor'}},
      {'mesh': 'plane', 'material': 'veil', 'transform': {'scale': [1,1,0.6], 'rotate_deg': [70,20,0], 'translate': [0.3,1.2,1.5]}})"),
                   "'direct': 'material'");
}

TEST(Reference, PrincipledUnderAnEnvironmentImage) {
  write_image("sky.exr", 8, 4, 3, [] {
    std::vector<float> pixels;
    for (int i = 0; i < 32; ++i) {
      const float v = i == 11 ? 6.0f : 0.2f + 0.02f * static_cast<float>(i % 8);
      pixels.insert(pixels.end(), {v, 0.9f * v, 0.7f * v});
    }
    return pixels;
  }());
  expect_reference(
      "principled under a sky",
      stage("", kMaterials + ", 'environment': {'image': 'sky.exr', 'rotate_y_deg': 40}",
            R"({'mesh': 'ball', 'material': 'gloss', 'transform': {'scale': 0.8, 'translate': [-1,0.8,0]}},
      {'mesh': 'cube', 'material': 'blend', 'transform': {'scale': 0.6, 'rotate_deg': [0,30,0], 'translate': [1,0.6,0]}})"),
      "'direct': 'material'");
}

TEST(Reference, ProceduralsInTheSun) {
  // A sun wide enough to be found by chance.
  expect_reference(
      "procedurals in the sun",
      stage(
          "",
          kMaterials +
              R"(, 'environment': {'radiance': [0.3,0.4,0.6]}, 'lights': {'sun': {'type': 'sun', 'direction': [1,1.5,0.5], 'irradiance': 2, 'diameter_deg': 60}})",
          R"({'mesh': 'drops', 'material': 'gloss', 'transform': {'scale': 0.8, 'rotate_deg': [0,40,20], 'translate': [0,1.1,0]}},
      {'mesh': 'sea', 'material': 'metal', 'transform': {'translate': [0,0.15,-3]}})"),
      "'direct': 'material'");
}

TEST(Reference, ManyLightsByTheBalanceHeuristic) {
  // Lamps that chance does not find, chosen by the tree: the other heuristic, and light sampling alone.
  std::string lights = "'lights': [";
  for (int i = 0; i < 24; ++i) {
    lights += (i > 0 ? ", " : "") + std::string("{'type': 'point', 'position': [") +
              std::to_string(-3 + i % 6) + "," + std::to_string(1.5 + i % 4 * 0.4) + "," +
              std::to_string(-2 + i / 6) + "], 'intensity': " + std::to_string(0.2 + 0.1 * (i % 5)) + "}";
  }
  const std::string json = stage("", kMaterials + ", " + lights + "]", kPanel + R"(,
      {'mesh': 'ball', 'material': 'gloss', 'transform': {'scale': 0.8, 'translate': [0,0.8,0]}})");
  expect_reference("many lights", json, "'heuristic': 'balance'");
  expect_reference("many lights", json, "'direct': 'light'");
}

}  // namespace
}  // namespace becalm::tracer::test
