// Media in whole renders: through interfaces and glass, around the camera, in each other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tracer/estimates.h"
#include "tests/tracer/shading/statistics.h"
#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer::test::participating_media_test {
namespace {

std::string scene(const std::string& integrator, const std::string& look_at, const std::string& media,
                  const std::string& objects, const std::string& more = "'environment': {'radiance': 1}, ",
                  const std::string& film = "'width': 4, 'height': 4") {
  return "{'film': {" + film + "}, 'integrator': {" + integrator +
         "}, 'camera': {'fov_y_deg': 0.01, 'look_at': {" + look_at + "}}, " + more + R"(
    'materials': {'air': {'type': 'interface'}, 'black': {'type': 'diffuse', 'reflectance': 0}, 'white': {'type': 'diffuse', 'reflectance': 1},
      'still': {'type': 'dielectric', 'ior': 1}, 'glass': {'type': 'dielectric', 'ior': 1.5}},
    'meshes': {'box': {'shape': 'cube'}, 'ball': {'shape': 'exact_sphere'}, 'plane': {'shape': 'rectangle'}},
    'media': {)" +
         media + "}, 'objects': [" + objects + "]}";
}

const std::string kAlongZ = "'eye': [0.1,0.2,20], 'target': [0.1,0.2,0]";
const std::string kAbsorber =
    "'dark': {'type': 'homogeneous', 'extinction': [0.7,0.1,0], 'albedo': 0}, "
    "'darker': {'type': 'homogeneous', 'extinction': 2, 'albedo': 0}";
const std::string kSlab = "'transform': {'scale': [9,9,0.75]}";  // 1.5 thick

V3f mean_color(const std::string& json, int spp = 4) {
  Scene scene = load_text(json);
  RenderReport report;
  const Frame frame = render_frame(scene, 1, options(spp, {Aov::variance}), &report).value();
  EXPECT_EQ(report.non_finite_samples, 0u);
  V3f mean;
  for (int c = 0; c < 3; ++c) mean[c] = static_cast<float>(mean_radiance(frame, c).value);
  return mean;
}

void expect_near(const V3f& actual, const V3f& expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], tolerance) << "channel " << c;
}

V3f transmitted(double distance) {
  return {static_cast<float>(std::exp(-0.7 * distance)), static_cast<float>(std::exp(-0.1 * distance)), 1.0f};
}

TEST(Media, AbsorbTheBackgroundAsBeerAndLambertSay) {
  for (const char* material : {"air", "still"}) {
    expect_near(mean_color(scene("'max_depth': 8", kAlongZ, kAbsorber,
                                 "{'mesh': 'box', 'interior': 'dark', 'material': '" + std::string(material) +
                                     "', " + kSlab + "}")),
                transmitted(1.5), 5e-6f);
  }
}

TEST(Media, AbsorbByTheirWholeThickness) {
  // Rays start off a surface by more than rounding errors, which is a tenth of this sheet.
  for (const char* material : {"air", "still"}) {
    for (const char* eye : {"[100,0,20]", "[112,0,9]"}) {
      const double cosine = eye[3] == '0' ? 1.0 : 0.6;
      const std::string look_at = "'eye': " + std::string(eye) + ", 'target': [100,0,0]";
      const V3f seen = mean_color(
          scene("'max_depth': 8", look_at, "'dark': {'type': 'homogeneous', 'extinction': 1e3, 'albedo': 0}",
                "{'mesh': 'box', 'interior': 'dark', 'material': '" + std::string(material) +
                    "', 'transform': {'scale': [9,9,0.5e-3], 'translate': [100,0,0]}}"));
      expect_near(seen, V3f(static_cast<float>(std::exp(-1.0 / cosine))), 1e-2f);
    }
  }
  // The same for light on its way to a floor below the sheet, which hides the lamp from nothing else.
  const auto lit = [](const std::string& sheet) {
    return mean_color(scene(
        "'max_depth': 1", "'eye': [102,0.5,0], 'target': [100,0,0]",
        "'dark': {'type': 'homogeneous', 'extinction': 1e3, 'albedo': 0}",
        "{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 5, 'translate': [100,0,0]}}" + sheet,
        "'lights': {'lamp': {'type': 'point', 'position': [100,4,0], 'intensity': 5}}, "));
  };
  expect_near(lit(", {'mesh': 'box', 'material': 'air', 'interior': 'dark', 'transform': {'scale': "
                  "[9,0.5e-3,9], 'translate': [100,2,0]}}") /
                  lit(""),
              V3f(static_cast<float>(std::exp(-1.0))), 1e-2f);
}

TEST(Media, AbsorbDirectLight) {
  // A lamp straight above the floor, and a slab between them; the camera looks in from below the slab.
  const auto lit = [](const std::string& slab) {
    return mean_color(scene("'max_depth': 1", "'eye': [2,0.5,0], 'target': [0,0,0]", kAbsorber,
                            "{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 5}}" + slab,
                            "'lights': {'lamp': {'type': 'point', 'position': [0,4,0], 'intensity': 5}}, "));
  };
  const V3f plain = lit("");
  expect_near(plain, V3f(5.0f / 16.0f / std::numbers::pi_v<float>), 1e-5f);
  expect_near(
      lit(", {'mesh': 'box', 'material': 'air', 'interior': 'dark', 'transform': {'scale': [9,0.5,9], "
          "'translate': [0,2,0]}}"),
      plain * transmitted(1.0), 5e-6f);
}

TEST(Media, SurroundTheCamera) {
  expect_near(
      mean_color(scene("'max_depth': 0", "'eye': [0,0,0.5], 'target': [0,0,-1]", kAbsorber,
                       "{'mesh': 'box', 'material': 'air', 'interior': 'dark', 'transform': {'scale': 2}}")),
      transmitted(2.5), 2e-6f);
}

TEST(Media, NestInEachOther) {
  // The one entered last fills the overlap: 1.5 of the ball's and 3 of the box's on each side, or half of it
  // from the middle.
  const std::string objects =
      "{'mesh': 'box', 'material': 'air', 'interior': 'dark', 'transform': {'scale': 2}}, "
      "{'mesh': 'ball', 'material': 'air', 'interior': 'darker', 'transform': {'scale': 0.5}}";
  const auto truth = [](double dark, double darker) {
    return transmitted(dark) * static_cast<float>(std::exp(-2.0 * darker));
  };
  expect_near(mean_color(scene("'max_depth': 0", "'eye': [0,0,20], 'target': [0,0,0]", kAbsorber, objects)),
              truth(3.0, 1.0), 2e-5f);
  expect_near(mean_color(scene("'max_depth': 0", "'eye': [0,0,0.1], 'target': [0,0,-1]", kAbsorber, objects)),
              truth(1.5, 0.6), 2e-5f);  // the camera stands in both
  expect_near(mean_color(scene("'max_depth': 0", "'eye': [0,0,1], 'target': [0,0,-1]", kAbsorber, objects)),
              truth(2.0, 1.0), 2e-5f);
}

TEST(Media, FillGlass) {
  // Light from all sides through a plate of glass that absorbs, at normal incidence: reflections inside add
  // up to a geometric series.
  const double r = 0.04;
  V3f truth;
  for (int c = 0; c < 3; ++c) {
    const double t = transmitted(1.5)[c];
    truth[c] = static_cast<float>(r + (1 - r) * (1 - r) * t * (1 + r * t) / (1 - r * r * t * t));
  }
  expect_near(mean_color(scene("'max_depth': 40, 'roulette_depth': 100", kAlongZ, kAbsorber,
                               "{'mesh': 'box', 'interior': 'dark', 'material': 'glass', " + kSlab + "}"),
                         1024),
              truth, 2e-3f);
}

/// Radiance that a plane slab sends back along the normal when a sun of irradiance 1 shines along it, by
/// paths of its own in double: only layers of depth, no surfaces, no integrator.
class SlabReference {
 public:
  SlabReference(double depth, double albedo, double g, bool reflected)
      : depth_(depth), albedo_(albedo), g_(g), reflected_(reflected) {}

  /// Mean and standard error.
  std::pair<double, double> estimate(int paths) {
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < paths; ++i) {
      const double x = path();
      sum += x;
      squares += x * x;
    }
    const double mean = sum / paths;
    return {mean, std::sqrt((squares / paths - mean * mean) / paths)};
  }

 private:
  double uniform() { return (random_.next() + 0.5 * 0x1p-24); }
  double phase(double cos_angle) const {
    return (1 - g_ * g_) / (4 * std::numbers::pi * std::pow(1 + g_ * g_ - 2 * g_ * cos_angle, 1.5));
  }
  /// From the eye, which looks down from above, or up from below; the sun shines down.
  double path() {
    double tau = reflected_ ? 0.0 : depth_, mu = reflected_ ? 1.0 : -1.0;  // cosine of the way with "down"
    double weight = 1.0, radiance = 0.0;
    for (;;) {
      tau += mu * -std::log(uniform());
      if (tau < 0.0 || tau > depth_) return radiance;
      weight *= albedo_;
      // Towards the sun is -1; light that travels down turns into the way back to the eye.
      radiance += weight * phase(-mu) * std::exp(-tau);
      const double cos_turn = turn();
      const double azimuth = 2 * std::numbers::pi * uniform();
      mu = mu * cos_turn +
           std::sqrt(std::max(0.0, (1 - mu * mu) * (1 - cos_turn * cos_turn))) * std::cos(azimuth);
    }
  }
  double turn() {
    if (g_ == 0.0) return 2 * uniform() - 1;
    const double s = (1 - g_ * g_) / (1 - g_ + 2 * g_ * uniform());
    return (1 + g_ * g_ - s * s) / (2 * g_);
  }

  double depth_, albedo_, g_;
  bool reflected_;
  TestRandom random_{11};
};

TEST(Media, ScatterAsASlabOfLayersDoes) {
  for (const double g : {0.0, 0.6, -0.4}) {
    for (const bool reflected : {true, false}) {
      const auto [truth, error] = SlabReference(2.0, 0.9, g, reflected).estimate(200000);
      // The sun straight above, with a width that the view along it does not see: 0 degrees.
      Scene scene = load_text(participating_media_test::scene(
          "'max_depth': 200",
          reflected ? "'eye': [0,9,0], 'target': [0,0,0], 'up': [1,0,0]"
                    : "'eye': [0,-9,0], 'target': [0,0,0], 'up': [1,0,0]",
          "'fog': {'type': 'homogeneous', 'extinction': 4, 'albedo': 0.9, 'g': " + std::to_string(g) + "}",
          "{'mesh': 'box', 'material': 'air', 'interior': 'fog', 'transform': {'scale': [1000,0.25,1000]}}",
          "'lights': {'sun': {'type': 'sun', 'direction': [0,1,0], 'irradiance': 1, 'diameter_deg': 0}}, ",
          "'width': 32, 'height': 32"));
      const Mean mean = mean_radiance(render_frame(scene, 1, options(64, {Aov::variance})).value());
      EXPECT_LT(std::hypot(mean.error, error), 0.02 * truth);
      EXPECT_NEAR(mean.value, truth, 4.0 * std::hypot(mean.error, error))
          << "g " << g << (reflected ? " reflected" : " transmitted");
    }
  }
}

TEST(Media, WhiteFogInAUniformSkyDisappears) {
  const auto fog = [](const std::string& integrator, const std::string& medium) {
    return R"({'film': {'width': 12, 'height': 12}, 'integrator': {'max_depth': 2000, 'roulette_depth': 3000, )" +
           integrator + R"(}, 'camera': {'fov_y_deg': 30, 'look_at': {'eye': [2,3,4], 'target': [0,0,0]}},
    'environment': {'radiance': [1,2,0.5]}, 'materials': {'air': {'type': 'interface'}}, 'meshes': {'box': {'shape': 'cube'}},
    'media': {'fog': )" +
           medium +
           "}, 'objects': [{'mesh': 'box', 'material': 'air', 'interior': 'fog', 'transform': {'rotate_deg': "
           "[10,20,30]}}]}";
  };
  const std::string media[] = {"{'type': 'homogeneous', 'extinction': 3, 'albedo': 1, 'g': 0.5}",
                               "{'type': 'cloud', 'extinction': 12, 'albedo': 1, 'g': -0.3, 'resolution': "
                               "[24,24,24], 'frequency': 3, 'seed': 2}"};
  for (const std::string& medium : media) {
    // Found by chance alone, every path carries exactly the sky.
    const V3f sky(1.0f, 2.0f, 0.5f);
    Scene exact = load_text(fog("'direct': 'material'", medium));
    const Frame frame = render_frame(exact, 1, options(8)).value();
    for (int i = 0; i < 12 * 12; ++i) {
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(frame.image(Aov::beauty).data()[4 * i + c], sky[c], 1e-4f) << medium;
    }
    for (const char* direct : {"mis", "light"}) {
      Scene noisy = load_text(fog("'direct': '" + std::string(direct) + "'", medium));
      const Mean mean = mean_radiance(render_frame(noisy, 1, options(64, {Aov::variance})).value());
      EXPECT_LT(mean.error, 0.02);
      EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.error) << direct << " " << medium;
    }
  }
}

TEST(Media, LightIsFoundEitherWayInsideFog) {
  expect_direct_modes_agree(
      R"({'film': {'width': 16, 'height': 12}, 'integrator': {'max_depth': 4, 'direct': 'DIRECT'},
    'camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,1.5,3.5], 'target': [0,0.8,0]}}, 'environment': {'radiance': [0.2,0.3,0.4]},
    'materials': {'white': {'type': 'diffuse', 'reflectance': [0.8,0.6,0.4]}, 'air': {'type': 'interface'}, 'glass': {'type': 'dielectric', 'ior': 1.3, 'roughness': 0.5}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'exact_sphere'}, 'box': {'shape': 'cube'}},
    'media': {'fog': {'type': 'homogeneous', 'extinction': [0.3,0.5,0.8], 'albedo': [0.9,0.7,0.5], 'g': 0.4},
              'cloud': {'type': 'cloud', 'extinction': 6, 'albedo': 0.8, 'resolution': [16,16,16], 'frequency': 2, 'seed': 3}},
    'objects': [
      {'mesh': 'plane', 'material': 'white', 'transform': {'scale': 4}},
      {'mesh': 'box', 'material': 'air', 'interior': 'fog', 'transform': {'scale': [3.5,1.9,3.8], 'translate': [0,1.95,0]}},
      {'mesh': 'box', 'material': 'air', 'interior': 'cloud', 'transform': {'scale': 0.6, 'rotate_deg': [20,30,0], 'translate': [0.9,1,0]}},
      {'mesh': 'ball', 'material': 'glass', 'interior': 'fog', 'transform': {'scale': 0.5, 'translate': [-0.8,0.6,0.6]}},
      {'mesh': 'plane', 'material': 'white', 'emission': [6,5,4], 'transform': {'scale': [1,1,0.7], 'rotate_deg': [160,0,0], 'translate': [0,3,0.6]}},
      {'mesh': 'ball', 'material': 'white', 'emission': [2,3,6], 'transform': {'scale': 0.4, 'translate': [-1.6,1.6,-0.6]}}]})",
      16, 20, 4);
}

TEST(Media, LightIsFoundEitherWayThroughRoughGlass) {
  // What a shadow ray passes is the medium on its side of the surface, not on the eye's.
  expect_direct_modes_agree(
      R"({'film': {'width': 16, 'height': 16}, 'integrator': {'max_depth': 4, 'direct': 'DIRECT'},
    'camera': {'fov_y_deg': 30, 'look_at': {'eye': [0,0,5], 'target': [0,0,0]}}, 'environment': {'radiance': 1},
    'materials': {'glass': {'type': 'dielectric', 'ior': 1.3, 'roughness': 0.6}},
    'meshes': {'ball': {'shape': 'exact_sphere'}},
    'media': {'fog': {'type': 'homogeneous', 'extinction': 0.5, 'albedo': 1}},
    'objects': [{'mesh': 'ball', 'material': 'glass', 'interior': 'fog'}]})",
      16, 20, 4);
}

TEST(Media, CopiesOfACloudShareItsVoxels) {
  const auto bytes_of = [](const std::string& scatter) {
    const Scene scene = load_text(participating_media_test::scene(
        "'max_depth': 4", kAlongZ,
        "'cloud': {'type': 'cloud', 'extinction': 6, 'albedo': 0.8, 'resolution': [16,16,16]}",
        "{'mesh': 'box', 'interior': 'cloud', 'material': 'air'" + scatter + "}"));
    return Snapshot(scene.description(), 1).media_bytes();
  };
  const std::size_t of_one = bytes_of("");
  EXPECT_GE(of_one, 16u * 16u * 16u * sizeof(float));
  EXPECT_EQ(bytes_of(", 'scatter': {'count': 9, 'area': [-50,-50,50,50]}"), of_one);
}

TEST(Media, HideWhatIsBehindWithTheirGuides) {
  // A dense black cloud is a surface to the eye: it covers, and its albedo is 0.
  Scene scene = load_text(participating_media_test::scene(
      "'max_depth': 4", kAlongZ,
      "'soot': {'type': 'homogeneous', 'extinction': [1e4,2e4,3e4], 'albedo': 1e-3}",
      "{'mesh': 'box', 'interior': 'soot', 'material': 'air', " + kSlab + "}", ""));
  const Frame frame = render_frame(scene, 1, options(16, {Aov::albedo, Aov::depth, Aov::object_id})).value();
  EXPECT_EQ(frame.image(Aov::beauty).at(1, 1, 3), 1.0f);
  EXPECT_NEAR(frame.image(Aov::depth).at(1, 1, 0), 20.0f - 0.75f, 1e-2f);
  EXPECT_LT(frame.image(Aov::albedo).at(1, 1, 1), 0.01f);
  EXPECT_EQ(frame.image(Aov::object_id).at(1, 1, 0), 1.0f);
  // Likewise one that never scatters.
  Scene black = load_text(participating_media_test::scene(
      "'max_depth': 4", kAlongZ, "'soot': {'type': 'homogeneous', 'extinction': 200, 'albedo': 0}",
      "{'mesh': 'box', 'interior': 'soot', 'material': 'air', " + kSlab + "}", ""));
  const Frame of_black = render_frame(black, 1, options(16, {Aov::albedo})).value();
  EXPECT_EQ(of_black.image(Aov::beauty).at(1, 1, 3), 1.0f);
  EXPECT_EQ(of_black.image(Aov::albedo).at(1, 1, 1), 0.0f);
}

TEST(Media, CoverByWhatTheyAbsorb) {
  // A plate that absorbs, alone and before a wall, leaves the same traces whether or not it scatters a
  // little.
  const auto frame_of = [](const std::string& albedo, const std::string& more) {
    Scene scene = load_text(participating_media_test::scene(
        "'max_depth': 4", kAlongZ,
        "'smoke': {'type': 'homogeneous', 'extinction': [2,1.5,1], 'albedo': " + albedo + "}",
        "{'mesh': 'box', 'interior': 'smoke', 'material': 'air', " + kSlab + "}" + more, "",
        "'width': 16, 'height': 16"));
    return render_frame(scene, 1, options(64, {Aov::variance, Aov::depth, Aov::object_id})).value();
  };
  const auto mean_of = [](const Frame& frame, Aov aov, int channel) {
    double sum = 0.0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) sum += frame.image(aov).at(x, y, channel);
    }
    return sum / (16 * 16);
  };
  const double truth = 1.0 - (std::exp(-3.0) + std::exp(-2.25) + std::exp(-1.5)) / 3.0;
  for (const char* albedo : {"0", "1e-3"}) {
    const Frame alone = frame_of(albedo, "");
    EXPECT_NEAR(mean_of(alone, Aov::beauty, 3), truth, 0.012) << albedo;  // four standard errors
    EXPECT_EQ(mean_of(alone, Aov::object_id, 0), 1.0) << albedo;
    EXPECT_NEAR(mean_of(alone, Aov::depth, 0), 19.74, 0.05) << albedo;
    const Frame before =
        frame_of(albedo, ", {'mesh': 'box', 'material': 'black', 'transform': {'translate': [0,0,-6]}}");
    EXPECT_EQ(mean_of(before, Aov::beauty, 3), 1.0) << albedo;
    EXPECT_EQ(mean_of(before, Aov::object_id, 0), 1.0) << albedo;
  }
  // The radiance that passes has no noise.
  const Frame lit = frame_of(
      "0", ", {'mesh': 'box', 'material': 'black', 'emission': 1, 'transform': {'translate': [0,0,-6]}}");
  EXPECT_NEAR(mean_of(lit, Aov::beauty, 0), std::exp(-3.0), 1e-4);
  EXPECT_LT(mean_of(lit, Aov::variance, 0), 1e-10);
}

}  // namespace
}  // namespace becalm::tracer::test::participating_media_test
