// Surfaces that are partly there: what passes is right on average, for every kind of ray.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/estimates.h"
#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

std::string scene(const std::string& integrator, const std::string& look_at, const std::string& objects,
                  const std::string& more = "") {
  return "{'film': {'width': 24, 'height': 24}, 'integrator': {" + integrator +
         "}, 'camera': {'fov_y_deg': 1, 'look_at': {" + look_at + "}}, " + more + R"(
    'materials': {'black': {'type': 'diffuse', 'reflectance': 0}, 'white': {'type': 'diffuse', 'reflectance': 1},
      'mirror': {'type': 'conductor', 'reflectance': 1},
      'half': {'type': 'diffuse', 'reflectance': 0, 'opacity': 0.5}, 'whole': {'type': 'diffuse', 'reflectance': 0, 'opacity': 1}},
    'meshes': {'plane': {'shape': 'rectangle'}},
    'objects': [)" +
         objects + "]}";
}

const std::string kFromAbove = "'eye': [0.3,5,0.2], 'target': [0.3,0,0.2], 'up': [0,0,-1]";
const std::string kLamp = "{'mesh': 'plane', 'material': 'black', 'emission': 1}";

std::string layer(double height, const std::string& more = "") {
  return ", {'mesh': 'plane', 'material': 'half', 'transform': {'translate': [0," + std::to_string(height) +
         ",0]" + more + "}}";
}
/// The same as an instance: it moves before and after.
std::string moving_layer(double height) {
  const std::string place = "'translate': [0," + std::to_string(height) + ",0]";
  return ", {'mesh': 'plane', 'material': 'half', 'transform': {'keys': [{'frame': 0, 'translate': [5,0,0]}, "
         "{'frame': 1, " +
         place + "}, {'frame': 2, 'translate': [5,0,0]}]}}";
}

/// Mean over the picture, with the error of independent yes and no answers.
void expect_share(const std::string& json, double truth, int spp = 32) {
  Scene scene = load_text(json);
  EXPECT_TRUE(scene.needs().alpha);
  const Mean mean = mean_radiance(render_frame(scene, 1, options(spp, {Aov::variance})).value());
  EXPECT_NEAR(mean.value, truth, 4.5 * std::sqrt(truth * (1.0 - truth) / (24.0 * 24.0 * spp)));
}

TEST(Opacity, CameraRaysPassHalfAndLayersMultiply) {
  const auto seen = [](const std::string& layers) {
    return scene("'max_depth': 0", kFromAbove, kLamp + layers);
  };
  expect_share(seen(layer(1)), 0.5);
  expect_share(seen(layer(1) + layer(2)), 0.25);
  expect_share(seen(layer(1) + layer(2) + layer(3)), 0.125);
  expect_share(seen(moving_layer(1)), 0.5);
  expect_share(seen(moving_layer(1) + moving_layer(2)), 0.25);
  expect_share(seen(layer(1) + moving_layer(2)), 0.25);
}

TEST(Opacity, ShadowRaysPassHalf) {
  const auto lit = [](const std::string& layers) {
    return scene("'max_depth': 1", "'eye': [2,1,0], 'target': [0.1,0,0.1]",
                 "{'mesh': 'plane', 'material': 'white'}" + layers,
                 "'lights': {'lamp': {'type': 'point', 'position': [0.1,4,0.1], 'intensity': "
                 "50.26548245743669}}, ");
  };
  // 4 pi 4 / 4^2 / pi = 1.
  Scene open = load_text(lit(""));
  EXPECT_FALSE(open.needs().alpha);
  EXPECT_NEAR(mean_radiance(render_frame(open, 1, options(8, {Aov::variance})).value()).value, 1.0, 1e-3);
  const std::string beside = ", 'scale': [0.2,1,0.2]";  // out of the camera's way
  expect_share(lit(layer(2, beside)), 0.5);
  expect_share(lit(layer(2, beside) + layer(3, beside)), 0.25);
}

TEST(Opacity, BouncesPassHalf) {
  // Layers that cover the whole sky above the floor.
  const auto lit = [](const std::string& layers) {
    return scene("'max_depth': 1, 'direct': 'material'", "'eye': [0.1,0.05,0], 'target': [0,0,0]",
                 "{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 3}}" + layers,
                 "'environment': {'radiance': 1}, ");
  };
  const std::string wide = ", 'scale': 1e5";
  expect_share(lit(layer(1, wide)), 0.5);
  expect_share(lit(layer(1, wide) + layer(2, wide)), 0.25);
}

TEST(Opacity, RaysOfAPathDecideIndependently) {
  // To a mirror and back through the same triangle: a quarter, not a half.
  expect_share(scene("'max_depth': 1", kFromAbove,
                     "{'mesh': 'plane', 'material': 'mirror', 'transform': {'scale': 2}}, "
                     "{'mesh': 'plane', 'material': 'black', 'emission': 1, 'transform': {'scale': 9, "
                     "'rotate_deg': [180,0,0], 'translate': [0,9,0]}}" +
                         layer(1)),
               0.25);
}

TEST(Opacity, SpatialSplitsAskOnce) {
  // Long thin strips at 45 degrees, which the builder cuts in many pieces: a triangle that is asked twice for
  // the same ray must answer the same, or less than half would pass.
  std::string obj;
  for (int i = 0; i < 400; ++i) {
    const double a = -2.0 + 0.01 * i, b = a + 0.01;
    char strip[400];
    const int n = 4 * i;
    std::snprintf(strip, sizeof strip, "v %g 0 %g\nv %g 0 %g\nv %g 0 %g\nv %g 0 %g\nf %d %d %d\nf %d %d %d\n",
                  a - 3, a + 3, b - 3, b + 3, b + 3, b - 3, a + 3, a - 3, n + 1, n + 2, n + 3, n + 1, n + 3,
                  n + 4);
    obj += strip;
  }
  write_file("strips.obj", obj);
  std::string json =
      scene("'max_depth': 0", kFromAbove,
            kLamp + ", {'mesh': 'strips', 'material': 'half', 'transform': {'translate': [0,1,0]}}");
  json.insert(json.find("'plane': {'shape'"), "'strips': {'obj': 'strips.obj'}, ");
  expect_share(json, 0.5, 64);
}

TEST(Opacity, OpaqueScenesNeedNoFilterFunctions) {
  Scene scene = load_text(
      test::scene("'max_depth': 0", kFromAbove, kLamp + ", {'mesh': 'plane', 'material': 'whole'}"));
  EXPECT_FALSE(scene.needs().alpha) << "an opacity of 1, and a material that no object has";
}

TEST(Opacity, MasksCutEmittersAndReceiversAlike) {
  // However light is found: through the camera, through shadow rays, through bounces; a lamp with holes
  // shines through what is there of it.
  const std::string mask = write_image("mask.png", 4, 1, 1, {0, 1, 0.25f, 1});
  expect_direct_modes_agree(
      R"({'film': {'width': 16, 'height': 16}, 'integrator': {'max_depth': 2, 'direct': 'DIRECT'},
    'camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,2,6], 'target': [0,0.8,0]}},
    'materials': {'white': {'type': 'diffuse', 'reflectance': 0.8},
      'leaf': {'type': 'diffuse', 'reflectance': 0.5, 'opacity': {'image': 'mask.png'}}},
    'meshes': {'plane': {'shape': 'rectangle'}},
    'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 4}},
      {'mesh': 'plane', 'material': 'leaf', 'transform': {'rotate_deg': [30,20,0], 'translate': [0,1,0.5]}},
      {'mesh': 'plane', 'material': 'leaf', 'emission': [4,3,2], 'two_sided': true, 'transform': {'rotate_deg': [150,0,0], 'translate': [0.5,3,0]}}]})",
      16, 16, 4);
}

}  // namespace
}  // namespace becalm::tracer::test
