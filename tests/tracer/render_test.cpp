// What holds for every frame: determinism, cancelling, variance, scale.
#include "tracer/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "frame/error.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

/// A room with a lamp, a mirror, glass, metal and a box that moves, in units of `unit`.
std::string room(double unit = 1.0, const std::string& film = "'width': 40, 'height': 30") {
  const auto v = [unit](double x, double y, double z) {
    char text[200];
    std::snprintf(text, sizeof text, "[%.9g,%.9g,%.9g]", x * unit, y * unit, z * unit);
    return std::string(text);
  };
  return "{'film': {" + film +
         "}, 'integrator': {'max_depth': 6}, 'camera': {'fov_y_deg': 50, 'look_at': {'eye': " + v(0, 1, 3.4) +
         ", 'target': " + v(0, 1, 0) + R"(}},
    'materials': {
      'white': {'type': 'diffuse', 'reflectance': 0.75}, 'red': {'type': 'diffuse', 'reflectance': [0.6,0.1,0.1]},
      'gold': {'type': 'conductor', 'reflectance': [1,0.78,0.34], 'roughness': 0.5},
      'mirror': {'type': 'conductor', 'reflectance': 0.95}, 'glass': {'type': 'dielectric', 'ior': 1.5}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'sphere', 'segments': 24}, 'box': {'shape': 'cube'}},
    'objects': [
      {'mesh': 'box', 'material': 'white', 'transform': {'scale': )" +
         v(2, 1.25, 4) + ", 'translate': " + v(0, 1.25, 0) + R"(}},
      {'mesh': 'plane', 'material': 'red', 'transform': {'scale': )" +
         v(1, 1, 1) + ", 'rotate_deg': [0,0,-90], 'translate': " + v(-1.99, 1, 0) + R"(}},
      {'mesh': 'plane', 'material': 'white', 'emission': 9, 'transform': {'scale': )" +
         v(0.7, 1, 0.7) + ", 'rotate_deg': [180,0,0], 'translate': " + v(0, 2.49, 0) + R"(}},
      {'mesh': 'ball', 'material': 'gold', 'transform': {'scale': )" +
         v(0.4, 0.4, 0.4) + ", 'translate': " + v(-0.9, 0.4, 0.2) + R"(}},
      {'mesh': 'ball', 'material': 'glass', 'transform': {'scale': )" +
         v(0.4, 0.4, 0.4) + ", 'translate': " + v(0.1, 0.4, 0.6) + R"(}},
      {'mesh': 'box', 'material': 'mirror', 'transform': {'scale': )" +
         v(0.3, 0.3, 0.3) + ", 'rotate_deg': [0,30,0], 'translate': " + v(0.9, 0.35, -0.7) + R"(}},
      {'mesh': 'box', 'material': 'red', 'transform': {'keys': [
         {'frame': 1, 'scale': )" +
         v(0.2, 0.2, 0.2) + ", 'translate': " + v(-0.2, 0.3, -0.9) + R"(},
         {'frame': 5, 'scale': )" +
         v(0.2, 0.2, 0.2) + ", 'translate': " + v(-0.2, 1.4, -0.9) + ", 'rotate_deg': [0,180,40]}]}}]}";
}

RenderOptions everything(int spp) {
  return options(
      spp, {Aov::albedo, Aov::normal, Aov::depth, Aov::motion, Aov::variance, Aov::half_a, Aov::half_b});
}

/// Bit for bit, in every image.
void expect_equal(const Frame& a, const Frame& b) {
  for (const AovInfo& entry : kAovTable) {
    const auto &da = a.image(entry.aov).data(), &db = b.image(entry.aov).data();
    ASSERT_EQ(da.size(), db.size()) << entry.name;
    EXPECT_EQ(da.empty() ? 0 : std::memcmp(da.data(), db.data(), da.size_bytes()), 0) << entry.name;
  }
}

TEST(Render, DoesNotDependOnThreadsOrTiles) {
  Scene scene = load_text(room());
  RenderOptions o = everything(4);
  std::optional<Frame> first;
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (const int tile : {8, 32, 1000}) {
      o.tile_px = tile;
      Frame frame = render_frame(scene, 2, o).value();
      if (first) {
        expect_equal(*first, frame);
      } else {
        first = std::move(frame);
      }
    }
  }
}

TEST(Render, DoesNotDependOnTheFramesBefore) {
  Scene walked = load_text(room()), jumped = load_text(room());
  for (const int frame : {1, 2, 5, 3}) render_frame(walked, frame, options(1));
  expect_equal(render_frame(walked, 4, everything(2)).value(),
               render_frame(jumped, 4, everything(2)).value());
}

TEST(Render, GivesFramesAndSeedsDifferentNoise) {
  Scene scene = load_text(room());
  const Frame a = render_frame(scene, 7, options(2)).value(), b = render_frame(scene, 8, options(2)).value();
  const Frame c = render_frame(scene, 7, options(2, {}, 1)).value();
  int equal_frames = 0, equal_seeds = 0;
  for (std::size_t i = 0; i < a.image(Aov::beauty).data().size(); i += 4) {
    equal_frames += a.image(Aov::beauty).data()[i] == b.image(Aov::beauty).data()[i];
    equal_seeds += a.image(Aov::beauty).data()[i] == c.image(Aov::beauty).data()[i];
  }
  EXPECT_LT(equal_frames, 100);  // of 1200; black pixels and the lamp may agree
  EXPECT_LT(equal_seeds, 100);
}

TEST(Render, StopsWhenCancelled) {
  Scene scene = load_text(room());
  std::atomic<bool> cancel{true};
  RenderOptions o = options(4);
  o.cancel = &cancel;
  EXPECT_FALSE(render_frame(scene, 1, o).has_value());
  cancel = false;
  o.tile_px = 4;
  o.progress = [&](double) { cancel = true; };
  EXPECT_FALSE(render_frame(scene, 1, o).has_value());
  cancel = false;
  o.progress = nullptr;
  EXPECT_TRUE(render_frame(scene, 1, o).has_value()) << "the scene is as good as before";
}

TEST(Render, ReportsProgressAndCounts) {
  Scene scene = load_text(room());
  std::atomic<int> calls{0};
  std::atomic<bool> reached_end{false};
  RenderOptions o = options(3);
  o.tile_px = 16;
  o.width = 33;
  o.height = 17;
  o.progress = [&](double share) {
    EXPECT_TRUE(share > 0.0 && share <= 1.0);
    if (share == 1.0) reached_end = true;
    ++calls;
  };
  RenderReport report;
  const Frame frame = render_frame(scene, 1, o, &report).value();
  EXPECT_EQ(frame.width(), 33);
  EXPECT_EQ(frame.height(), 17);
  EXPECT_GT(calls, 1);
  EXPECT_TRUE(reached_end);
  EXPECT_EQ(report.samples, 33u * 17u * 3u);
  EXPECT_EQ(report.non_finite_samples, 0u);
}

TEST(Render, OnePixelIsAFrame) {
  Scene scene = load_text(room());
  RenderOptions o = everything(2);
  o.width = o.height = 1;
  EXPECT_TRUE(std::isfinite(render_frame(scene, 1, o).value().image(Aov::beauty).at(0, 0, 0)));
}

TEST(Render, RefusesImpossibleSampleCounts) {
  Scene scene = load_text(room());
  EXPECT_THROW(render_frame(scene, 1, options(0)), Error);
  EXPECT_THROW(render_frame(scene, 1, options(65537)), Error);
  EXPECT_THROW(render_frame(scene, 1, options(1, {Aov::half_a})), Error);
}

TEST(Render, ReplaysASample) {
  Scene scene = load_text(room());
  RenderOptions o = options(1);
  const Frame frame = render_frame(scene, 1, o).value();
  const std::vector<std::string> lines = describe_sample(scene, 1, o, {20, 25, 0});
  ASSERT_GE(lines.size(), 2u);
  const float* p = frame.image(Aov::beauty).pixel(20, 25).data();
  float r = 0, g = 0, b = 0;
  ASSERT_EQ(std::sscanf(lines.back().c_str(), "radiance [%f, %f, %f]", &r, &g, &b), 3) << lines.back();
  EXPECT_EQ(V3f(r, g, b), V3f(p[0], p[1], p[2]));
  EXPECT_THROW(describe_sample(scene, 1, o, {40, 0, 0}), Error);
}

TEST(Variance, OfOneSampleIsItsSquare) {
  Scene scene = load_text(room());
  const Frame frame = render_frame(scene, 1, options(1, {Aov::variance})).value();
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const float v = frame.image(Aov::beauty).at(x, y, 1);
      EXPECT_FLOAT_EQ(frame.image(Aov::variance).at(x, y, 1), v * v);
    }
  }
}

TEST(Variance, AgreesWithTheSpreadAmongSeeds) {
  // Samples of a pixel are stratified, and so are the blocks whose spread tells the variance; the whole is so
  // a little more. By the spread of single samples the sum for 32 would be 3.1 times the truth.
  Scene scene = load_text(room(1.0, "'width': 20, 'height': 15"));
  constexpr int seeds = 96, pixels = 20 * 15;
  for (const int spp : {2, 8, 32}) {
    std::vector<double> sum(pixels), squares(pixels), reported(pixels), ratios;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      const Frame frame = render_frame(scene, 1, options(spp, {Aov::variance}, seed)).value();
      for (int i = 0; i < pixels; ++i) {
        const double v = frame.image(Aov::beauty).data()[4 * i + 1];
        sum[i] += v;
        squares[i] += v * v;
        reported[i] += frame.image(Aov::variance).data()[3 * i + 1] / seeds;
      }
    }
    double among_seeds = 0.0, all_reported = 0.0;
    for (int i = 0; i < pixels; ++i) {
      const double truth = (squares[i] - sum[i] * sum[i] / seeds) / (seeds - 1);
      among_seeds += truth;
      all_reported += reported[i];
      if (truth > 0.0) ratios.push_back(reported[i] / truth);
    }
    std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
    const double median = ratios[ratios.size() / 2];
    EXPECT_GT(median, 0.95) << spp;
    EXPECT_LT(median, 1.3) << spp;
    EXPECT_GT(all_reported, 0.95 * among_seeds) << spp;
    EXPECT_LT(all_reported, 2.2 * among_seeds) << spp;
  }
}

TEST(Scale, ThePictureDoesNotDependOnTheUnit) {
  Scene metre = load_text(room());
  const Frame reference = render_frame(metre, 1, everything(4)).value();
  for (const double unit : {1e-4, 1e6}) {
    Scene scaled = load_text(room(unit));
    const Frame frame = render_frame(scaled, 1, everything(4)).value();
    // The same paths are walked: only those that pass within rounding errors of an edge may differ.
    int different = 0;
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        const float a = reference.image(Aov::beauty).at(x, y, 1), b = frame.image(Aov::beauty).at(x, y, 1);
        different += std::abs(a - b) > 1e-3f * std::max(a, b);
        EXPECT_NEAR(frame.image(Aov::depth).at(x, y, 0) / unit, reference.image(Aov::depth).at(x, y, 0),
                    1e-4);
        EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 1), reference.image(Aov::motion).at(x, y, 1), 1e-3);
      }
    }
    EXPECT_LT(different, 12) << "of 1200 pixels at unit " << unit;
  }
}

TEST(Scale, ClosedBoxesDoNotLeak) {
  // The sky of radiance 1000 around a closed grey box must not be seen from inside it, at any size or place.
  const struct {
    const char* place;
    double size, x;
    double largest_mean;
  } cases[] = {
      {"'scale': 1", 1, 0, 0},
      {"'scale': 1e-4", 1e-4, 0, 0},
      {"'scale': 1e6", 1e6, 0, 0},
      {"'scale': [1,20,1], 'rotate_deg': [12,34,56]", 1, 0, 0},
      {"'scale': 1, 'translate': [9,0,0]", 1, 9, 0},
      // Here the box is 5000 units in the last place wide: points within one of an edge may lie outside.
      {"'scale': 0.01, 'translate': [30,0,0]", 0.01, 30, 1}};
  for (const auto& [place, size, x, largest_mean] : cases) {
    for (const bool moving : {false, true}) {
      const std::string transform =
          moving ? std::string("{'keys': [{'frame': 1, ") + place + "}, {'frame': 9, 'translate': [1,0,0]}]}"
                 : std::string("{") + place + "}";
      char camera[300];
      std::snprintf(camera, sizeof camera, "{'eye': [%.9g,%.9g,%.9g], 'target': [%.9g,%.9g,%.9g]}",
                    x + 0.1 * size, 0.2 * size, 0.3 * size, x - 0.3 * size, -0.2 * size, -0.5 * size);
      Scene scene = load_text(
          "{'film': {'width': 24, 'height': 24}, 'integrator': {'max_depth': 20, 'roulette_depth': 100},"
          "'environment': {'radiance': 1000}, 'camera': {'fov_y_deg': 120, 'look_at': " +
          std::string(camera) + R"(},
        'materials': {'grey': {'type': 'diffuse', 'reflectance': 0.9}}, 'meshes': {'box': {'shape': 'cube'}},
        'objects': [{'mesh': 'box', 'material': 'grey', 'transform': )" +
          transform + "}]}");
      const Frame frame = render_frame(scene, 1, options(16, {Aov::variance})).value();
      EXPECT_LE(mean_radiance(frame).value, largest_mean) << place << (moving ? " moving" : " static");
    }
  }
}

}  // namespace
}  // namespace becalm::tracer::test
