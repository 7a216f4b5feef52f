// Whole renders of scenes whose radiance is known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

std::string integrator(int max_depth, const std::string& direct, int roulette_depth = 100) {
  return "'integrator': {'max_depth': " + std::to_string(max_depth) + ", 'direct': '" + direct +
         "', 'roulette_depth': " + std::to_string(roulette_depth) + "}";
}

Frame render(const std::string& json, int spp, std::uint32_t seed = 0) {
  Scene scene = load_text(json);
  RenderReport report;
  Frame frame = render_frame(scene, 1, options(spp, {Aov::variance}, seed), &report).value();
  EXPECT_EQ(report.non_finite_samples, 0u);
  return frame;
}

/// The mean must lie within 4 standard errors of the truth (once in 15,000 by chance, and the seed is fixed),
/// and the error must be small enough for that to mean something.
void expect_mean(const Frame& frame, double truth, double largest_error, int channel = 0) {
  const Mean mean = mean_radiance(frame, channel);
  EXPECT_LT(mean.error, largest_error * truth);
  EXPECT_NEAR(mean.value, truth, 4.0 * mean.error + 1e-5 * truth);
}

/// The camera inside a closed box whose walls all emit E and reflect rho.
std::string glowing_box(const std::string& integrator_text) {
  return R"({'film': {'width': 16, 'height': 16}, )" + integrator_text + R"(,
    'camera': {'fov_y_deg': 80, 'look_at': {'eye': [0.3,0.2,0.6], 'target': [0,0,-1]}},
    'materials': {'wall': {'type': 'diffuse', 'reflectance': [0.5, 0.8, 0]}},
    'meshes': {'box': {'shape': 'cube'}},
    'objects': [{'mesh': 'box', 'material': 'wall', 'emission': 3, 'two_sided': true,
                 'transform': {'scale': [1, 1.5, 2]}}]})";
}

class GlowingBox : public testing::TestWithParam<const char*> {};

TEST_P(GlowingBox, HoldsTheTruncatedSeries) {
  // L = E (1 + rho + ... + rho^depth), whatever the shape of the box.
  for (const int depth : {0, 1, 4}) {
    const Frame frame = render(glowing_box(integrator(depth, GetParam())), 256);
    for (int channel = 0; channel < 3; ++channel) {
      const double rho = std::array{0.5, 0.8, 0.0}[channel];
      const double truth = 3.0 * (1.0 - std::pow(rho, depth + 1)) / (1.0 - rho);
      expect_mean(frame, truth, 0.01, channel);
    }
  }
}

TEST_P(GlowingBox, ReachesTheFullSeriesUnderRoulette) {
  const Frame frame = render(glowing_box(integrator(200, GetParam(), 2)), 256);
  expect_mean(frame, 3.0 / (1.0 - 0.5), 0.01, 0);
  expect_mean(frame, 3.0 / (1.0 - 0.8), 0.01, 1);
}

INSTANTIATE_TEST_SUITE_P(Radiance, GlowingBox, testing::Values("mis", "light", "material"),
                         [](const auto& info) { return std::string(info.param); });

class DiscOverPlane : public testing::TestWithParam<const char*> {};

TEST_P(DiscOverPlane, GivesTheKnownIrradiance) {
  // Below the centre of a disc of radius r at height h: E = pi L r^2 / (r^2 + h^2), and the plane shows rho E
  // / pi.
  const std::string scene = R"({'film': {'width': 8, 'height': 8}, )" + integrator(1, GetParam()) + R"(,
    'camera': {'fov_y_deg': 0.01, 'look_at': {'eye': [3,1,0], 'target': [0,0,0]}},
    'materials': {'grey': {'type': 'diffuse', 'reflectance': 0.6}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'disc': {'shape': 'disc', 'segments': 512}},
    'objects': [{'mesh': 'plane', 'material': 'grey'},
                {'mesh': 'disc', 'material': 'grey', 'emission': 7,
                 'transform': {'scale': 0.75, 'rotate_deg': [180,0,0], 'translate': [0,1.5,0]}}]})";
  const double r2 = 0.75 * 0.75, h2 = 1.5 * 1.5;
  expect_mean(render(scene, 1024), 0.6 * 7.0 * r2 / (r2 + h2), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Radiance, DiscOverPlane, testing::Values("mis", "light", "material"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Radiance, EmittersShineFromTheFrontAlone) {
  const auto lit = [](const std::string& more) {
    const Frame frame = render(R"({'film': {'width': 4, 'height': 4}, 'integrator': {'max_depth': 0},
      'camera': {'fov_y_deg': 1, 'look_at': {'eye': [0,3,0], 'target': [0,0,0], 'up': [0,0,-1]}},
      'materials': {'black': {'type': 'diffuse', 'reflectance': 0}},
      'meshes': {'plane': {'shape': 'rectangle'}},
      'objects': [{'mesh': 'plane', 'material': 'black', 'emission': 2)" +
                                   more + "}]}",
                               1);
    return frame.image(Aov::beauty).at(2, 2, 0);
  };
  EXPECT_EQ(lit(""), 2.0f);
  EXPECT_EQ(lit(", 'transform': {'rotate_deg': [180,0,0]}"), 0.0f);
  EXPECT_EQ(lit(", 'two_sided': true, 'transform': {'rotate_deg': [180,0,0]}"), 2.0f);
  EXPECT_EQ(lit(", 'transform': {'scale': [-1,1,1]}"), 2.0f) << "mirroring keeps the outside outside";
  EXPECT_EQ(lit(", 'transform': {'scale': [1,-1,1]}"), 0.0f) << "... and turns the front over";
}

TEST(Radiance, MirroredEmittersLightTheirOutside) {
  // A mirrored closed emitter lights its surroundings as the same emitter without mirroring does.
  const auto lit = [](const std::string& scale) {
    return render(R"({'film': {'width': 8, 'height': 8}, 'integrator': {'max_depth': 1, 'direct': 'light'},
      'camera': {'fov_y_deg': 20, 'look_at': {'eye': [0,3,6], 'target': [0,0,2.5]}},
      'materials': {'white': {'type': 'diffuse', 'reflectance': 1}},
      'meshes': {'plane': {'shape': 'rectangle'}, 'box': {'shape': 'cube'}},
      'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 5}},
                  {'mesh': 'box', 'material': 'white', 'emission': 1,
                   'transform': {'translate': [0,1.5,0], 'scale': )" +
                      scale + "}}]}",
                  64);
  };
  const Mean plain = mean_radiance(lit("1")), mirrored = mean_radiance(lit("[-1,1,1]"));
  EXPECT_GT(plain.value, 0.05);
  EXPECT_NEAR(plain.value, mirrored.value, 4.0 * std::hypot(plain.error, mirrored.error));
}

/// One object under a sky of radiance 1.
std::string furnace(const std::string& material, const std::string& mesh, int max_depth) {
  return R"({'film': {'width': 24, 'height': 24}, )" + integrator(max_depth, "mis", 1000) + R"(,
    'camera': {'fov_y_deg': 30, 'look_at': {'eye': [1.5,2,3], 'target': [0,0,0]}},
    'environment': {'radiance': 1},
    'materials': {'m': )" +
         material + R"(},
    'meshes': {'mesh': {'shape': ')" +
         mesh + R"('}},
    'objects': [{'mesh': 'mesh', 'material': 'm', 'transform': {'rotate_deg': [10,20,30]}}]})";
}

TEST(Furnace, WhiteDiffuseDisappears) {
  expect_mean(render(furnace("{'type': 'diffuse', 'reflectance': 1}", "cube", 4), 64), 1.0, 0.003);
}

TEST(Furnace, PerfectMirrorsAndGlassDisappear) {
  // Every sample carries exactly 1, but for the truncation of paths inside the glass and the rounding of
  // weights.
  for (const char* material :
       {"{'type': 'conductor', 'reflectance': 1}", "{'type': 'dielectric', 'ior': 1.5}",
        "{'type': 'dielectric', 'ior': 0.8}", "{'type': 'dielectric', 'ior': 1}"}) {
    const Frame frame = render(furnace(material, "sphere", 200), 16);
    const Mean mean = mean_radiance(frame);
    EXPECT_NEAR(mean.value, 1.0, 2e-3) << material;
    EXPECT_LE(mean.value, 1.0 + 1e-5) << material;
  }
}

TEST(Furnace, RoughSurfacesLoseLittle) {
  // Further bounces between microfacets are given back, below alpha 0.1 not all of them. One scattering alone
  // would lose 6 % of the roughest of these.
  const struct {
    const char* material;
    double least;
  } cases[] = {{"{'type': 'conductor', 'reflectance': 1, 'roughness': 0.1}", 0.998},
               {"{'type': 'dielectric', 'ior': 1.5, 'roughness': 0.1}", 0.993},
               {"{'type': 'conductor', 'reflectance': 1, 'roughness': 0.3}", 0.995},
               {"{'type': 'dielectric', 'ior': 1.5, 'roughness': 0.3}", 0.985}};
  for (const auto& [material, least] : cases) {
    for (const char* mesh : {"cube", "sphere"}) {
      const Mean mean = mean_radiance(render(furnace(material, mesh, 64), 64));
      EXPECT_GT(mean.value, least) << material << mesh;
      EXPECT_LT(mean.value, 1.0 + 4.0 * mean.error) << material << mesh;
    }
  }
}

TEST(Furnace, GreyDiffuseShowsItsReflectance) {
  Scene scene = load_text(furnace("{'type': 'diffuse', 'reflectance': [0.2,0.5,0.9]}", "cube", 1));
  const Frame frame = render_frame(scene, 1, options(64, {Aov::variance})).value();
  for (int channel = 0; channel < 3; ++channel) {
    const double rho = std::array{0.2, 0.5, 0.9}[channel];
    const Mean center = mean_radiance(frame, channel, 10, 10, 14, 14);
    EXPECT_NEAR(center.value, rho, 4.0 * center.error + 1e-5);
  }
}

TEST(Radiance, ExtremeEmissionStaysFinite) {
  for (const char* emission : {"1e-30", "1e30"}) {
    std::string text = glowing_box(integrator(4, "mis"));
    text.replace(text.find("'emission': 3"), 13, std::string("'emission': ") + emission);
    const Frame frame = render(text, 16);
    const Mean mean = mean_radiance(frame, 0);
    EXPECT_NEAR(mean.value / std::atof(emission), 1.9375, 0.05) << emission;
  }
}

TEST(Radiance, ShadowsNearLampsDoNotDependOnTheSizeOfTheScene) {
  // A blocker just below a point light leaves the ground dark, however far the ground reaches.
  for (const char* ground : {"1", "1e3", "1e6"}) {
    Scene scene = load_text(std::string(R"({'film': {'width': 4, 'height': 4}, 'integrator': {'max_depth': 1},
      'camera': {'fov_y_deg': 1, 'look_at': {'eye': [0,2,0], 'target': [0,0,0], 'up': [0,0,-1]}},
      'lights': [{'type': 'point', 'position': [0,5,0], 'intensity': 100}],
      'materials': {'white': {'type': 'diffuse', 'reflectance': 0.8}}, 'meshes': {'plane': {'shape': 'rectangle'}},
      'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': )") +
                            ground + R"(}},
                  {'mesh': 'plane', 'material': 'white', 'transform': {'scale': 0.5, 'translate': [0,4.9,0]}}]})");
    EXPECT_EQ(mean_radiance(render_frame(scene, 1, options(2, {Aov::variance})).value()).value, 0.0)
        << ground;
  }
}

}  // namespace
}  // namespace becalm::tracer::test
