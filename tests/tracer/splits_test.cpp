// The parts of the beauty that add up to it, ids, guides through what does not scatter, and shared jitter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/tracer/everything_scene.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/camera.h"
#include "tracer/sampling/jitter.h"

namespace becalm::tracer::test {
namespace {

/// The largest |a - b| in parts of a, of all pixels and channels.
template <class Sum>
double worst_relative_error(const Frame& frame, const Sum& sum) {
  double worst = 0.0;
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const double whole = frame.image(Aov::beauty).at(x, y, c);
        if (whole > 0.0) worst = std::max(worst, std::abs(whole - sum(x, y, c)) / whole);
      }
    }
  }
  return worst;
}

TEST(Splits, AddUpToTheBeauty) {
  Scene scene = load_text(everything_scene());
  RenderOptions o = options(8, {Aov::direct, Aov::indirect});
  o.light_groups = true;
  const Frame frame = render_frame(scene, 2, o).value();
  std::set<std::string> names;
  for (const LightGroup& group : frame.light_groups()) names.insert(group.name);
  EXPECT_EQ(names, (std::set<std::string>{"lamps", "panels", "sky", "sun"}));
  EXPECT_LT(worst_relative_error(frame,
                                 [&](int x, int y, int c) {
                                   return double{frame.image(Aov::direct).at(x, y, c)} +
                                          frame.image(Aov::indirect).at(x, y, c);
                                 }),
            1e-5);
  EXPECT_LT(worst_relative_error(frame,
                                 [&](int x, int y, int c) {
                                   double sum = 0.0;
                                   for (const LightGroup& group : frame.light_groups())
                                     sum += group.radiance.at(x, y, c);
                                   return sum;
                                 }),
            1e-5);
  for (const LightGroup& group : frame.light_groups())
    EXPECT_GT(*std::ranges::max_element(group.radiance.data()), 0.0f) << group.name;
  for (const Aov aov : {Aov::direct, Aov::indirect})
    EXPECT_GT(*std::ranges::max_element(frame.image(aov).data()), 0.0f) << info(aov).name;
}

TEST(Splits, DoNotChangeTheBeauty) {
  Scene scene = load_text(everything_scene());
  RenderOptions o = options(2, {Aov::direct, Aov::indirect, Aov::albedo, Aov::object_id});
  o.light_groups = true;
  const Frame with = render_frame(scene, 2, o).value(), without = render_frame(scene, 2, options(2)).value();
  for (std::size_t i = 0; i < with.image(Aov::beauty).data().size(); ++i)
    ASSERT_EQ(with.image(Aov::beauty).data()[i], without.image(Aov::beauty).data()[i]);
}

TEST(Splits, GroupsAreTheRendersOfTheirLightsAlone) {
  const auto text = [](bool first, bool second) {
    return R"({'film': {'width': 12, 'height': 12}, 'integrator': {'max_depth': 4, 'direct': 'material', 'roulette_depth': 9},
    'camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,2,5], 'target': [0,0.5,0]}},
    'materials': {'white': {'type': 'diffuse', 'reflectance': 0.8}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}},
    'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 4}},
      {'mesh': 'cube', 'material': 'white', 'transform': {'scale': 0.5, 'translate': [0,0.5,0]}},
      {'mesh': 'plane', 'material': 'white', 'group': 'a', 'emission': )" +
           std::string(first ? "[3,2,1]" : "[1e-30,0,0]") +
           R"(, 'transform': {'rotate_deg': [150,0,0], 'translate': [1,3,0]}},
      {'mesh': 'plane', 'material': 'white', 'group': 'b', 'emission': )" +
           (second ? "[1,2,5]" : "[1e-30,0,0]") +
           R"(, 'transform': {'rotate_deg': [150,0,60], 'translate': [-2,2,0]}}]})";
  };
  // Found by chance alone, paths do not depend on what shines, so the parts are those renders bit for bit
  // within rounding.
  Scene both = load_text(text(true, true)), a = load_text(text(true, false)),
        b = load_text(text(false, true));
  RenderOptions o = options(16);
  o.light_groups = true;
  const Frame whole = render_frame(both, 1, o).value();
  const Frame parts[] = {render_frame(a, 1, options(16)).value(), render_frame(b, 1, options(16)).value()};
  ASSERT_EQ(whole.light_groups().size(), 2u);
  for (int g = 0; g < 2; ++g) {
    EXPECT_EQ(whole.light_groups()[g].name, g == 0 ? "a" : "b");
    for (int i = 0; i < 144; ++i) {
      for (int c = 0; c < 3; ++c) {
        const float part = parts[g].image(Aov::beauty).data()[4 * i + c];
        EXPECT_NEAR(whole.light_groups()[g].radiance.data()[3 * i + c], part, 1e-5f * part + 1e-20f);
      }
    }
  }
}

TEST(Splits, DirectIsTheRenderOfOneScattering) {
  // Without mirrors and glass: what max_depth 1 shows.
  const auto text = [](int depth) {
    return R"({'film': {'width': 12, 'height': 12}, 'integrator': {'roulette_depth': 9, 'max_depth': )" +
           std::to_string(depth) + R"(},
    'camera': {'fov_y_deg': 40, 'look_at': {'eye': [0,2,5], 'target': [0,0.5,0]}}, 'environment': {'radiance': 0.5},
    'materials': {'white': {'type': 'diffuse', 'reflectance': 0.8}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}},
    'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 4}},
      {'mesh': 'cube', 'material': 'white', 'transform': {'scale': 0.5, 'translate': [0,0.5,0]}}]})";
  };
  Scene one = load_text(text(1)), many = load_text(text(5));
  const Frame direct = render_frame(one, 1, options(8)).value();
  const Frame split = render_frame(many, 1, options(8, {Aov::direct, Aov::indirect})).value();
  double indirect = 0.0;
  for (int i = 0; i < 144; ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(split.image(Aov::direct).data()[3 * i + c], direct.image(Aov::beauty).data()[4 * i + c],
                  1e-6f);
      indirect += split.image(Aov::indirect).data()[3 * i + c];
    }
  }
  EXPECT_GT(indirect, 1.0);
}

TEST(Ids, AreTheMajoritysWithBackgroundCounted) {
  // Bars whose edges cut pixels at a third: of 9 strata, most samples decide.
  Scene scene = load_text(
      R"({'film': {'width': 16, 'height': 3, 'filter': {'type': 'box', 'radius_px': 0.5}}, 'integrator': {'max_depth': 0},
    'camera': {'fov_y_deg': 0.8594, 'look_at': {'eye': [0,0,200], 'target': [0,0,0]}},
    'materials': {'a': {'type': 'diffuse', 'reflectance': 0}, 'b': {'type': 'diffuse', 'reflectance': 0}},
    'meshes': {'plane': {'shape': 'rectangle'}},
    'objects': [{'mesh': 'plane', 'material': 'b', 'transform': {'rotate_deg': [90,0,0], 'scale': [1.3,1,9], 'translate': [-1.3,0,0]}},
      {'mesh': 'plane', 'material': 'a', 'transform': {'rotate_deg': [90,0,0], 'scale': [1.15,1,9], 'translate': [1.15,0,0]}}]})");
  const Frame frame = render_frame(scene, 1, options(64, {Aov::object_id, Aov::material_id})).value();
  // 1 unit a pixel, the picture's middle at 0: the bars reach from -2.6 to 0 and from 0 to 2.3.
  for (int x = 0; x < 16; ++x) {
    const float object = x < 5 ? 0.0f : x < 8 ? 1.0f : x < 10 ? 2.0f : 0.0f;
    EXPECT_EQ(frame.image(Aov::object_id).at(x, 1, 0), object) << x;
    EXPECT_EQ(frame.image(Aov::material_id).at(x, 1, 0), object == 0.0f ? 0.0f : 3.0f - object) << x;
  }
}

TEST(Guides, PassThroughInterfacesMirrorsAndGlass) {
  // Towards a wall of known albedo and normal: through an empty interface, a plate of index 1, a mirror.
  const auto seen = [](const std::string& objects, const std::string& look_at) {
    Scene scene = load_text("{'film': {'width': 3, 'height': 3, " + std::string(kPointFilter) +
                            "}, 'integrator': {'max_depth': 8}, 'environment': {'radiance': 1}, 'camera': "
                            "{'fov_y_deg': 1, 'look_at': {" +
                            look_at + R"(}},
      'materials': {'wall': {'type': 'diffuse', 'reflectance': [0.8,0.6,0.4]}, 'air': {'type': 'interface'}, 'plate': {'type': 'dielectric', 'ior': 1}, 'mirror': {'type': 'conductor', 'reflectance': [0.5,1,1]}},
      'media': {'void': {'type': 'homogeneous', 'extinction': 0, 'albedo': 0}},
      'meshes': {'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}},
      'objects': [{'mesh': 'plane', 'material': 'wall', 'transform': {'scale': 3, 'rotate_deg': [90,0,0], 'translate': [0,0,-5]}})" +
                            objects + "]}");
    return render_frame(scene, 1, options(1, {Aov::albedo, Aov::normal, Aov::depth, Aov::object_id})).value();
  };
  const auto expect = [](const Frame& frame, const V3f& albedo, float depth, float object) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(frame.image(Aov::albedo).at(1, 1, c), albedo[c], 2e-3f);
    EXPECT_NEAR(frame.image(Aov::normal).at(1, 1, 2), 1.0f, 1e-5f);
    EXPECT_NEAR(frame.image(Aov::depth).at(1, 1, 0), depth, 1e-4f);
    EXPECT_EQ(frame.image(Aov::object_id).at(1, 1, 0), object);
  };
  const std::string straight = "'eye': [0,0,5], 'target': [0,0,0]";
  const V3f wall(0.8f, 0.6f, 0.4f);
  expect(seen("", straight), wall, 10.0f, 1.0f);
  for (const char* interior : {"", ", 'interior': 'void'"}) {
    // Depth and ids are the wall's too: an interface is no surface.
    expect(seen(", {'mesh': 'cube', 'material': 'air'" + std::string(interior) + "}", straight), wall, 10.0f,
           1.0f);
  }
  expect(seen(", {'mesh': 'cube', 'material': 'plate'}", straight), wall, 4.0f, 2.0f);
  // A mirror in the plane x = 0, as bright in green and blue as the wall.
  const Frame mirrored =
      seen(", {'mesh': 'plane', 'material': 'mirror', 'transform': {'rotate_deg': [0,0,-90]}}",
           "'eye': [1,0,2], 'target': [0,0,0]");
  const float red = mirrored.image(Aov::albedo).at(1, 1, 0);
  EXPECT_GT(red, 0.5f * wall.x);
  EXPECT_LT(red, 0.6f * wall.x) << "a little above normal incidence";
  expect(mirrored, V3f(red, wall.y, wall.z), std::sqrt(5.0f), 2.0f);
}

TEST(Jitter, IsHaltonsAndRepeats) {
  const Jitter jitter{8};
  const double twos[] = {1 / 2., 1 / 4., 3 / 4., 1 / 8., 5 / 8., 3 / 8., 7 / 8., 1 / 16.};
  const double threes[] = {1 / 3., 2 / 3., 1 / 9., 4 / 9., 7 / 9., 2 / 9., 5 / 9., 8 / 9.};
  for (int frame = 0; frame < 24; ++frame) {
    const V2f p = jitter.point(frame, 1, 0);
    EXPECT_FLOAT_EQ(p.x, static_cast<float>(twos[frame % 8]));
    EXPECT_FLOAT_EQ(p.y, static_cast<float>(threes[frame % 8]));
    // With 3 samples a frame: the next three points.
    for (std::uint32_t sample = 0; sample < 3; ++sample)
      EXPECT_FLOAT_EQ(jitter.point(frame, 3, sample).x, static_cast<float>(twos[(3 * frame + sample) % 8]));
  }
  EXPECT_EQ(jitter.point(-3, 1, 0), jitter.point(5, 1, 0)) << "frames before the first";
  EXPECT_EQ(jitter.point(7'000'000'003, 65536, 1), jitter.point(3, 65536, 1));
}

TEST(Jitter, IsSharedByAllPixels) {
  // The normal of the unit sphere is the point that was hit, and its projection where the sample lay.
  Scene scene = load_text(
      R"({'frames': {'first': 3, 'last': 12}, 'film': {'width': 8, 'height': 6, 'jitter_cycle': 6, 'filter': {'type': 'box', 'radius_px': 0.5}},
    'integrator': {'max_depth': 0}, 'camera': {'fov_y_deg': 5, 'look_at': {'eye': [0,0,9], 'target': [0,0,0]}},
    'materials': {'m': {'type': 'diffuse', 'reflectance': 0.5}}, 'meshes': {'ball': {'shape': 'exact_sphere'}},
    'objects': [{'mesh': 'ball', 'material': 'm'}]})");
  const Camera camera({{0, 0, 9}, {0, 0, 0}, {0, 1, 0}}, 5.0, 8, 6);
  const Jitter jitter{6};
  for (const int spp : {1, 2, 5}) {
    for (int number = 3; number <= 12; ++number) {
      V2f mean(0.0f);
      for (int i = 0; i < spp; ++i)
        mean += jitter.point(number - 3, static_cast<std::uint32_t>(spp), static_cast<std::uint32_t>(i)) /
                static_cast<float>(spp);
      const Frame frame = render_frame(scene, number, options(spp, {Aov::normal})).value();
      ASSERT_TRUE(frame.jitter());
      ASSERT_EQ(frame.jitter()->positions_px.size(), static_cast<std::size_t>(spp));
      EXPECT_NEAR(frame.jitter()->positions_px[0].x, jitter.point(number - 3, spp, 0).x - 0.5f, 1e-6f);
      for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 8; ++x) {
          const float* n = frame.image(Aov::normal).pixel(x, y).data();
          const V2d seen = camera.project(V3d(n[0], n[1], n[2]).normalized()).value() - V2d(x, y);
          // Points of a sphere do not average quite as their projections do.
          EXPECT_NEAR(seen.x, mean.x, spp == 1 ? 1e-4 : 0.02) << number << ": " << x << "," << y;
          EXPECT_NEAR(seen.y, mean.y, spp == 1 ? 1e-4 : 0.02) << number << ": " << x << "," << y;
        }
      }
    }
  }
}

TEST(Jitter, OfACheckerboardIsWholeInTheFramesOfEachParity) {
  Scene scene = load_text(
      R"({'frames': {'first': 0, 'last': 7}, 'film': {'width': 2, 'height': 2, 'jitter_cycle': 4},
    'camera': {'look_at': {'eye': [0,0,9], 'target': [0,0,0]}}, 'materials': {}, 'meshes': {}, 'objects': []})");
  RenderOptions o = options(1);
  o.checkerboard = true;
  for (const int parity : {0, 1}) {
    std::set<std::pair<float, float>> positions_px;
    for (int number = parity; number < 8; number += 2) {
      const V2f at = render_frame(scene, number, o).value().jitter()->positions_px.at(0);
      positions_px.emplace(at.x, at.y);
    }
    EXPECT_EQ(positions_px.size(), 4u) << parity;
  }
}

}  // namespace
}  // namespace becalm::tracer::test
