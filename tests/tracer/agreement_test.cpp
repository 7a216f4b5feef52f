// Light sampling alone, material sampling alone and both must agree in expectation: errors in a pdf, a
// weight, a visibility or the light's choice show as a difference.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

constexpr int kSize = 24;
constexpr int kBlock = 6;
constexpr int kSpp = 256;
/// Largest |z| of 16 blocks x 3 channels x 3 comparisons that chance exceeds once in a thousand (Sidak).
constexpr double kLargestZ = 4.4;

Frame render(std::string json, const std::string& direct, std::uint32_t seed) {
  json.replace(json.find("DIRECT"), 6, direct);
  Scene scene = load_text(json);
  RenderReport report;
  Frame frame = render_frame(scene, 1, options(kSpp, {Aov::variance}, seed), &report).value();
  EXPECT_EQ(report.non_finite_samples, 0u);
  return frame;
}

void expect_agreement(const std::string& json) {
  const char* const modes[] = {"light", "material", "mis', 'heuristic': 'balance", "mis"};
  std::vector<Frame> frames;
  for (std::uint32_t i = 0; i < 4; ++i) frames.push_back(render(json, modes[i], i));
  for (int a = 0; a < 3; ++a) {
    const Mean whole = mean_radiance(frames[a]);
    EXPECT_LT(whole.error, 0.01 * whole.value) << "too noisy to tell";
    for (int channel = 0; channel < 3; ++channel) {
      for (int y = 0; y < kSize; y += kBlock) {
        for (int x = 0; x < kSize; x += kBlock) {
          const Mean m = mean_radiance(frames[a], channel, x, y, x + kBlock, y + kBlock);
          const Mean n = mean_radiance(frames[3], channel, x, y, x + kBlock, y + kBlock);
          const double error = std::hypot(m.error, n.error);
          // Rounding and the geometric tolerances allow 1e-4.
          EXPECT_LE(std::abs(m.value - n.value), kLargestZ * error + 1e-4 * n.value)
              << modes[a] << " against mis, block " << x << "," << y << " channel " << channel << ": "
              << m.value << " and " << n.value << " +- " << error;
        }
      }
    }
  }
}

std::string scene(const std::string& environment, const std::string& materials, const std::string& objects) {
  return "{'film': {'width': 24, 'height': 24}, 'integrator': {'max_depth': 4, 'direct': 'DIRECT'}, " +
         environment +
         R"('camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,1.5,5], 'target': [0,0.8,0]}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'sphere', 'segments': 32}, 'box': {'shape': 'cube'},
               'disc': {'shape': 'disc'}},
    'materials': {'white': {'type': 'diffuse', 'reflectance': [0.8,0.6,0.4]}, )" +
         materials + R"(},
    'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 4}}, )" +
         objects + "]}";
}

const std::string kLamps = R"(
    {'mesh': 'plane', 'material': 'white', 'emission': [4,3,2], 'transform': {'scale': [1,1,0.6], 'rotate_deg': [150,0,0], 'translate': [0,3,1]}},
    {'mesh': 'ball', 'material': 'white', 'emission': [1,2,5], 'transform': {'scale': 0.5, 'translate': [-1.6,1,-0.6]}},
    {'mesh': 'disc', 'material': 'white', 'emission': [0.5,3,1], 'two_sided': true, 'transform': {'scale': 0.8, 'rotate_deg': [0,0,70], 'translate': [1.8,1,-0.5]}})";

TEST(Agreement, DiffuseAndAreaLights) {
  expect_agreement(
      scene("", "'x': {'type': 'diffuse', 'reflectance': 0.5}",
            "{'mesh': 'ball', 'material': 'x', 'transform': {'scale': 0.7, 'translate': [0.2,0.7,0.5]}}, " +
                kLamps));
}

TEST(Agreement, RoughMetalAndAreaLights) {
  expect_agreement(scene(
      "", "'x': {'type': 'conductor', 'reflectance': [0.9,0.7,0.5], 'roughness': 0.5}",
      "{'mesh': 'box', 'material': 'x', 'transform': {'scale': 0.6, 'rotate_deg': [0,30,0], 'translate': "
      "[0.2,0.7,0.5]}}, " +
          kLamps));
}

TEST(Agreement, RoughGlassAndAreaLights) {
  expect_agreement(
      scene("", "'x': {'type': 'dielectric', 'ior': 1.4, 'roughness': 0.6}",
            "{'mesh': 'ball', 'material': 'x', 'transform': {'scale': 0.7, 'translate': [0.2,0.7,0.5]}}, " +
                kLamps));
}

TEST(Agreement, EnvironmentWithAreaLights) {
  expect_agreement(
      scene("'environment': {'radiance': [0.3,0.6,1]}, ",
            "'x': {'type': 'conductor', 'reflectance': 0.8, 'roughness': 0.4}",
            "{'mesh': 'ball', 'material': 'x', 'transform': {'scale': 0.7, 'translate': [0.2,0.7,0.5]}}, " +
                kLamps));
}

/// Means over a lone two-sided lamp of emission 1 that fills the image, with each way to find direct light.
std::vector<double> lone_lamp(const std::string& mesh, const std::string& transform, const V3d& center) {
  std::vector<double> means;
  for (const char* direct : {"light", "material", "mis', 'heuristic': 'balance", "mis"}) {
    Scene scene = load_text(fmt::format(
        R"({{'film': {{'width': 8, 'height': 8}}, 'integrator': {{'max_depth': 1, 'direct': '{}'}},
        'camera': {{'fov_y_deg': 2, 'look_at': {{'eye': [{},{},{}], 'target': [{},{},{}]}}}},
        'materials': {{'white': {{'type': 'diffuse', 'reflectance': 0.8}}}}, 'meshes': {{'lamp': {}}},
        'objects': [{{'mesh': 'lamp', 'material': 'white', 'emission': 1, 'two_sided': true, 'transform': {}}}]}})",
        direct, center.x, center.y, center.z + 3, center.x, center.y, center.z, mesh, transform));
    means.push_back(mean_radiance(render_frame(scene, 1, options(16, {Aov::variance})).value()).value);
  }
  return means;
}

TEST(Agreement, FlatLampsDoNotLightThemselvesFarFromTheOrigin) {
  write_file("triangle.obj", "v -2 -1 1\nv 2 -1 0\nv 0 2 -0.5\nf 1 2 3\n");
  for (const char* mesh :
       {"{'shape': 'rectangle'}", "{'obj': 'triangle.obj'}", "{'shape': 'disc'}", "{'shape': 'cube'}"}) {
    for (const double distance : {0.0, 10.0, 100.0, 1000.0}) {
      const V3d center = V3d(0.8, 0.27, 0.53) * distance;
      const std::string transform =
          fmt::format("{{'scale': 0.3, 'rotate_deg': [37,21,64], 'translate': [{},{},{}]}}", center.x,
                      center.y, center.z);
      for (const double mean : lone_lamp(mesh, transform, center))
        EXPECT_NEAR(mean, 1.0, 1e-6) << mesh << " at " << distance;
    }
  }
}

TEST(Agreement, FlatLampsDoNotLightThemselvesWhereTheirMeshIsFarFromItsOrigin) {
  write_file("far.obj",
             "v 799.7 269.8 530.1\nv 800.3 269.9 530\nv 800.2 270.3 529.8\nv 799.6 270.2 529.9\nf 1 2 3 4\n");
  for (const double mean : lone_lamp("{'obj': 'far.obj'}", "{'translate': [-800,-270,-530]}", V3d(0.0)))
    EXPECT_NEAR(mean, 1.0, 1e-6);
}

}  // namespace
}  // namespace becalm::tracer::test
