// What is seen and lit while the shutter is open.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/tracer/estimates.h"
#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer::test {
namespace {

constexpr int kWidth = 64;

/// A camera at z = 10 that sees 8 pixels a unit in the plane z = 0.
std::string camera(const std::string& shutter, const std::string& more = "") {
  return "'camera': {'fov_y_deg': 22.619864948040426, 'shutter': " + shutter +
         ", 'look_at': {'eye': [0,0,10], 'target': [0,0,0]" + more + "}}";
}

std::string scene(const std::string& camera, const std::string& objects, int height = 32) {
  return "{'film': {'width': 64, 'height': " + std::to_string(height) + ", " + kPointFilter +
         "}, 'integrator': {'max_depth': 0}, " + camera + R"(,
    'materials': {'black': {'type': 'diffuse', 'reflectance': 0}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'cube': {'shape': 'cube'}, 'ball': {'shape': 'exact_sphere'}},
    'objects': [)" +
         objects + "]}";
}

TEST(MotionBlur, LinearMotionGivesTheTrapezoidOfCoverage) {
  // A bar of 4 px runs from -1 to +1 unit while the shutter is open: its centre from 24 px to 40 px. A pixel
  // centre is covered for the time in which the bar's centre is within 2 px of it.
  Scene scene = load_text(test::scene(camera("[0.25,0.75]"),
                                      R"({'mesh': 'plane', 'material': 'black', 'emission': 3,
      'transform': {'keys': [{'frame': 1, 'rotate_deg': [90,0,0], 'scale': [0.25,1,1], 'translate': [-2,0,0]},
                             {'frame': 2, 'rotate_deg': [90,0,0], 'scale': [0.25,1,1], 'translate': [2,0,0]}]}})"));
  constexpr int spp = 256;
  const Frame frame = render_frame(scene, 1, options(spp)).value();
  double covered_somewhere = 0.0;
  for (int x = 0; x < kWidth; ++x) {
    const double enters = (x + 0.5 - 2.0 - 24.0) / 16.0, leaves = (x + 0.5 + 2.0 - 24.0) / 16.0;
    const double share = std::max(0.0, std::min(1.0, leaves) - std::max(0.0, enters));
    // Times are stratified: one of `spp` intervals a sample.
    EXPECT_NEAR(frame.image(Aov::beauty).at(x, 16, 0), 3.0 * share, 3.0 * 2.0 / spp) << x;
    EXPECT_NEAR(frame.image(Aov::beauty).at(x, 16, 3), share, 2.0 / spp) << x;
    covered_somewhere += share;
  }
  EXPECT_NEAR(covered_somewhere, 4.0, 1e-9);
}

TEST(MotionBlur, EmissionIsThatInTheMiddleOfTheShutter) {
  Scene scene = load_text(test::scene(camera("[0,1]"), R"({'mesh': 'cube', 'material': 'black',
      'emission': {'keys': [{'frame': 1, 'value': 0}, {'frame': 2, 'value': 1}]}})"));
  // From frame 0 to 1 only what is in the middle changes.
  for (const auto& [frame, emission] : {std::pair(0, 0.0f), std::pair(1, 0.5f), std::pair(2, 1.0f)}) {
    const Frame rendered = render_frame(scene, frame, options(1)).value();
    EXPECT_EQ(rendered.image(Aov::beauty).at(kWidth / 2, 16, 0), emission) << frame;
  }
}

/// Beauty and normal of frame 1 averaged over closed shutters at equally spaced times from 0 to 1.
Frame average_of_moments(const std::function<std::string(const std::string&)>& json, int moments) {
  Frame sum;
  for (int i = 0; i < moments; ++i) {
    const std::string time = std::to_string((i + 0.5) / moments);
    Scene scene = load_text(json("[" + time + "," + time + "]"));
    EXPECT_FALSE(scene.needs().motion_blur);
    const Frame frame = render_frame(scene, 1, options(1, {Aov::normal})).value();
    if (i == 0) {
      sum = Frame(1, frame.width(), frame.height());
      sum.add(Aov::beauty);
      sum.add(Aov::normal);
    }
    for (const Aov aov : {Aov::beauty, Aov::normal}) {
      for (std::size_t k = 0; k < sum.image(aov).data().size(); ++k)
        sum.image(aov).data()[k] += frame.image(aov).data()[k] / static_cast<float>(moments);
    }
  }
  return sum;
}

void expect_blur_averages_moments(const std::function<std::string(const std::string&)>& json) {
  constexpr int moments = 256;
  const Frame truth = average_of_moments(json, moments);
  Scene scene = load_text(json("[0,1]"));
  const Frame blurred = render_frame(scene, 1, options(1024, {Aov::normal})).value();
  for (const Aov aov : {Aov::beauty, Aov::normal}) {
    double difference = 0.0, sum = 0.0, worst = 0.0;
    for (std::size_t k = 0; k < truth.image(aov).data().size(); ++k) {
      const double d = std::abs(blurred.image(aov).data()[k] - truth.image(aov).data()[k]);
      difference += d;
      worst = std::max(worst, d);
      sum += std::abs(truth.image(aov).data()[k]);
    }
    // Each edge that passes a pixel is resolved to 1/256 of the time by the moments and to 1/1024 by the
    // samples; a pixel sees a few edges.
    EXPECT_GT(sum, 100.0);
    EXPECT_LT(difference, 0.01 * sum) << info(aov).name;
    EXPECT_LT(worst, 0.05) << info(aov).name;
  }
}

TEST(MotionBlur, RotatingObjectsAverageTheirMoments) {
  expect_blur_averages_moments([](const std::string& shutter) {
    return scene(camera(shutter),
                 R"({'mesh': 'cube', 'material': 'black', 'emission': 1, 'transform': {'keys': [
      {'frame': 1, 'scale': [1.5,0.4,0.7], 'rotate_deg': [0,0,0], 'translate': [-1,0.3,0]},
      {'frame': 2, 'scale': [1.2,0.5,0.7], 'rotate_deg': [60,-40,220], 'translate': [1.5,-0.4,1]}]}})");
  });
}

TEST(MotionBlur, MovingCamerasAverageTheirMoments) {
  expect_blur_averages_moments([](const std::string& shutter) {
    return scene(
        "'camera': {'fov_y_deg': 25, 'shutter': " + shutter +
            R"(, 'look_at': {'interpolation': 'smooth', 'keys': [
      {'frame': 0, 'eye': [-2,0.5,9], 'target': [0.4,0,0], 'up': [0.1,1,0]},
      {'frame': 1, 'eye': [0,0.5,10], 'target': [0,0,0]},
      {'frame': 2, 'eye': [1,-0.5,8], 'target': [-0.5,0.5,0], 'up': [0.3,1,0]}]}})",
        R"({'mesh': 'cube', 'material': 'black', 'emission': 1, 'transform': {'scale': [0.8,0.5,0.5]}},
                    {'mesh': 'ball', 'material': 'black', 'emission': [0.2,1,0.5], 'transform': {'scale': 0.6, 'translate': [1.6,0.6,-2]}})");
  });
}

TEST(MotionBlur, MotionStepsOnlyWhereSomethingMoves) {
  const auto moving = [](const std::string& shutter) {
    return scene(camera(shutter), R"({'mesh': 'cube', 'material': 'black'},
      {'mesh': 'cube', 'material': 'black', 'transform': {'keys': [{'frame': 1}, {'frame': 3, 'translate': [1,0,0]}]}},
      {'mesh': 'ball', 'material': 'black', 'transform': {'keys': [{'frame': 1}, {'frame': 9, 'rotate_deg': [0,90,0], 'translate': [0,1,0]}]}})");
  };
  Scene open = load_text(moving("[0,0.5]"));
  EXPECT_TRUE(open.needs().motion_blur);
  const auto sizes = [](Scene& scene, int frame) { return scene.at_frame(frame).intersector().size(); };
  EXPECT_EQ(sizes(open, 1).baked_objects, 1u);
  EXPECT_EQ(sizes(open, 1).instances, 2u);
  EXPECT_EQ(sizes(open, 1).motion_instances, 2u);
  EXPECT_EQ(sizes(open, 3).motion_instances, 1u) << "the cube has come to rest";
  EXPECT_EQ(sizes(open, 20).motion_instances, 0u);
  EXPECT_EQ(sizes(open, 2).motion_instances, 2u) << "... and back";
  Scene closed = load_text(moving("[0.5,0.5]"));
  EXPECT_FALSE(closed.needs().motion_blur);
  EXPECT_EQ(sizes(closed, 1).instances, 2u);
  EXPECT_EQ(sizes(closed, 1).motion_instances, 0u);
}

TEST(MotionBlur, ObjectsComeToRestAndMoveAgainBetweenFrames) {
  // The number of time steps of an instance changes from frame to frame.
  const std::string json =
      scene(camera("[0,1]"),
            R"({'mesh': 'cube', 'material': 'black', 'emission': 1, 'transform': {'keys': [
      {'frame': 2, 'rotate_deg': [0,0,0]}, {'frame': 3, 'rotate_deg': [0,0,300], 'translate': [1,0,0]}, {'frame': 4, 'rotate_deg': [0,0,300], 'translate': [2,0,0]}]}})");
  Scene walked = load_text(json);
  for (const int number : {1, 2, 3, 4, 2}) {
    Scene fresh = load_text(json);
    const Frame a = render_frame(walked, number, options(4)).value();
    const Frame b = render_frame(fresh, number, options(4)).value();
    for (std::size_t i = 0; i < a.image(Aov::beauty).data().size(); ++i)
      ASSERT_EQ(a.image(Aov::beauty).data()[i], b.image(Aov::beauty).data()[i]) << number;
  }
}

TEST(MotionBlur, MovingLightsAreFoundEitherWay) {
  expect_direct_modes_agree(
      R"({'film': {'width': 24, 'height': 16}, 'integrator': {'max_depth': 2, 'direct': 'DIRECT'},
    'camera': {'fov_y_deg': 40, 'shutter': [0,1], 'look_at': {'eye': [0,2,6], 'target': [0,0.8,0]}},
    'materials': {'white': {'type': 'diffuse', 'reflectance': 0.8}, 'gloss': {'type': 'conductor', 'reflectance': [0.9,0.6,0.4], 'roughness': 0.6}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'exact_sphere'}, 'cube': {'shape': 'cube'}},
    'objects': [
      {'mesh': 'plane', 'material': 'white', 'transform': {'scale': 4}},
      {'mesh': 'cube', 'material': 'gloss', 'transform': {'scale': 0.6, 'translate': [0,0.6,0], 'rotate_deg': [0,30,0]}},
      {'mesh': 'plane', 'material': 'white', 'emission': [6,4,2], 'transform': {'keys': [
        {'frame': 1, 'scale': [-0.8,1,0.6], 'rotate_deg': [150,0,0], 'translate': [-1.5,2.5,1]},
        {'frame': 2, 'scale': [-0.4,1,0.6], 'rotate_deg': [190,50,90], 'translate': [1.5,2,1]}]}},
      {'mesh': 'ball', 'material': 'white', 'emission': [1,3,8], 'transform': {'keys': [
        {'frame': 1, 'scale': 0.3, 'translate': [-2,0.7,-1]}, {'frame': 2, 'scale': 0.6, 'translate': [1.8,1.1,0.5]}]}}]})",
      16, 24, 4);
}

TEST(MotionBlur, ALightsMotionSweepsItsIrradiance) {
  // A small lamp that runs past a floor lights it as the mean over its places does.
  const auto json = [](const std::string& shutter) {
    return R"({'film': {'width': 24, 'height': 8}, 'integrator': {'max_depth': 1, 'direct': 'light'},
    'camera': {'fov_y_deg': 30, 'shutter': )" +
           shutter + R"(, 'look_at': {'eye': [0,4,4], 'target': [0,0,0]}},
    'materials': {'white': {'type': 'diffuse', 'reflectance': 1}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'exact_sphere'}},
    'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 5}},
      {'mesh': 'ball', 'material': 'white', 'emission': 9, 'transform': {'keys': [
        {'frame': 1, 'scale': 0.2, 'translate': [-3,0.8,0]}, {'frame': 2, 'scale': 0.2, 'translate': [3,0.8,0]}]}}]})";
  };
  Scene blurred = load_text(json("[0,1]"));
  const Frame frame = render_frame(blurred, 1, options(1024, {Aov::variance})).value();
  std::vector<double> truth(24 * 8, 0.0);
  constexpr int moments = 64;
  for (int i = 0; i < moments; ++i) {
    const std::string time = std::to_string((i + 0.5) / moments);
    Scene scene = load_text(json("[" + time + "," + time + "]"));
    const Frame moment = render_frame(scene, 1, options(16, {}, 100 + static_cast<std::uint32_t>(i))).value();
    for (int p = 0; p < 24 * 8; ++p) truth[p] += moment.image(Aov::beauty).data()[4 * p] / moments;
  }
  for (int y = 0; y < 8; y += 4) {
    for (int x = 0; x < 24; x += 4) {
      const Mean mean = mean_radiance(frame, 0, x, y, x + 4, y + 4);
      double expected = 0.0;
      for (int p = 0; p < 16; ++p) expected += truth[(y + p / 4) * 24 + x + p % 4] / 16.0;
      EXPECT_LT(mean.error, 0.12 * expected);
      // The moments' own error is about half of it.
      EXPECT_NEAR(mean.value, expected, 4.5 * mean.error) << x << "," << y;
    }
  }
}

TEST(MotionBlur, NormalsOfMovingMirroredAndStretchedObjects) {
  const auto normals = [](const std::string& transform, const std::string& shutter) {
    Scene scene = load_text(test::scene(
        camera(shutter), "{'mesh': 'ball', 'material': 'black', 'transform': " + transform + "}", 48));
    return render_frame(scene, 1, options(1, {Aov::normal, Aov::depth})).value();
  };
  const std::string place = "'scale': [-2,1.2,0.5], 'rotate_deg': [20,30,40], 'translate': [0.2,0.1,0]";
  const Frame still = normals("{" + place + "}", "[0,0]");
  // So slow that it stays put, yet not so slow that it counts as standing still.
  const Frame moving = normals(
      "{'keys': [{'frame': 1, " + place +
          "}, {'frame': 2, 'scale': [-2,1.2,0.5], 'rotate_deg': [20,30,40], 'translate': [0.2001,0.1,0]}]}",
      "[0,0.01]");
  int hits = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (!std::isfinite(still.image(Aov::depth).at(x, y, 0))) continue;
      ++hits;
      EXPECT_NEAR(moving.image(Aov::depth).at(x, y, 0), still.image(Aov::depth).at(x, y, 0), 1e-3);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(moving.image(Aov::normal).at(x, y, c), still.image(Aov::normal).at(x, y, c), 2e-3);
    }
  }
  EXPECT_GT(hits, 200);
}

/// Two keys, four frames apart.
std::string keys(const char* first, const std::string& from, const std::string& to) {
  const double start = std::stod(first);
  return "{'keys': [{'frame': " + std::to_string(start) + from + "}, {'frame': " + std::to_string(start + 4) +
         to + "}]}";
}

TEST(MotionBlur, ProceduralSurfacesAreThoseInTheMiddleOfTheShutter) {
  const auto depth = [](const std::string& shutter, const char* first_key, int number) {
    Scene scene = load_text("{'film': {'width': 32, 'height': 16, " + std::string(kPointFilter) +
                            R"(}, 'camera': {'fov_y_deg': 30, 'shutter': )" + shutter +
                            R"(, 'look_at': {'eye': [0,3,4], 'target': [0,0,0]}},
    'materials': {'black': {'type': 'diffuse', 'reflectance': 0}},
    'meshes': {'sea': {'procedural': 'ocean', 'size': 20, 'wavelength': 2, 'wave_height': 0.4, 'time_s': )" +
                            keys(first_key, ", 'value': 0", ", 'value': 4") +
                            "}}, 'objects': [{'mesh': 'sea', 'material': 'black'}]}");
    scene.at_frame(1);
    const Frame frame = render_frame(scene, number, options(1, {Aov::depth})).value();
    const auto data = frame.image(Aov::depth).data();
    return std::vector<float>(data.begin(), data.end());
  };
  for (const int number : {1, 2}) {
    const std::vector<float> open = depth("[0,1]", "0", number), middle = depth("[0,0]", "-0.5", number);
    for (std::size_t i = 0; i < open.size(); ++i) ASSERT_NEAR(open[i], middle[i], 1e-4f) << number;
  }
}

TEST(MotionBlur, CloudsAreThoseInTheMiddleOfTheShutter) {
  const auto cloud = [](const std::string& shutter, const char* first_key, int number) {
    Scene scene = load_text("{" + camera(shutter) + R"(, 'materials': {'air': {'type': 'interface'}},
    'meshes': {'cube': {'shape': 'cube'}},
    'media': {'cloud': {'type': 'cloud', 'extinction': 2, 'albedo': 0.5, 'resolution': [8,8,8], 'evolution': )" +
                            keys(first_key, ", 'value': 0", ", 'value': 1") +
                            R"(}},
    'objects': [{'mesh': 'cube', 'material': 'air', 'interior': 'cloud', 'transform': )" +
                            keys(first_key, "", ", 'translate': [2,0,0]") + "}]}");
    scene.at_frame(1);
    return std::get<GridMedium>(*scene.at_frame(number).object(0).interior);
  };
  for (const int number : {1, 2}) {
    const GridMedium open = cloud("[0,1]", "0", number), middle = cloud("[0,0]", "-0.5", number);
    EXPECT_EQ(open.baked_shape, middle.baked_shape) << number;
    EXPECT_TRUE(open.world_to_voxels.equalWithAbsError(middle.world_to_voxels, 1e-5f)) << number;
  }
}

TEST(MotionSteps, FollowTheCurveWithinAThousandth) {
  const Shutter shutter{-0.25, 0.75};
  const auto curve = [](std::vector<TransformCurve::Key> keys) {
    return TransformCurve(std::move(keys), Interpolation::linear);
  };
  const auto worst = [&](const TransformCurve& c, double radius) {
    const int segments = motion_segments(c, 1.0, shutter, radius);
    const MotionSteps<double> steps = motion_steps(c, 1.0, shutter, segments);
    double worst = 0.0;
    for (int i = 0; i <= 997; ++i) {
      const double time = i / 997.0;
      const M44d exact = transform_at(c, shutter.at(1.0, time)), made = steps.at(static_cast<float>(time));
      for (const V3d& p : {V3d(radius, 0, 0), V3d(0, radius, 0), V3d(0.6, 0, -0.8) * radius})
        worst = std::max(worst, (transform_point(p, exact) - transform_point(p, made)).length() / radius);
    }
    return std::pair(segments, worst);
  };
  const auto [straight, straight_error] =
      worst(curve({{0.0, {0, 0, 0, 10, 20, 30, 1, 1, 1}}, {2.0, {5, 1, 0, 10, 20, 30, 1, 1, 1}}}), 2.0);
  EXPECT_EQ(straight, 1);
  EXPECT_LT(straight_error, 1e-5);
  const auto [turning, turning_error] =
      worst(curve({{0.0, {0, 0, 0, 0, 0, 0, 1, 1, 1}}, {2.0, {5, 1, 0, 90, 20, 200, 1, 1, 1}}}), 3.0);
  EXPECT_GT(turning, 4);
  EXPECT_LT(turning_error, 1e-3);
  const auto [still, still_error] =
      worst(curve({{5.0, {0, 0, 0, 0, 0, 0, 1, 1, 1}}, {6.0, {5, 1, 0, 90, 20, 200, 1, 1, 1}}}), 3.0);
  EXPECT_EQ(still, 0);
  EXPECT_EQ(still_error, 0.0);
  // Back at its place each quarter of the interval.
  std::vector<TransformCurve::Key> bounces;
  for (int i = 0; i <= 8; ++i)
    bounces.push_back({0.75 + i / 8.0, {0, i % 2 == 0 ? 0.0 : 2.0, 0, 0, 0, 0, 1, 1, 1}});
  const auto [bouncing, bouncing_error] = worst(curve(bounces), 1.0);
  EXPECT_GE(bouncing, 8);
  EXPECT_LT(bouncing_error, 1e-3);
  const auto spinning = [&](double degrees) {
    return worst(curve({{0.0, {0, 0, 0, 0, 0, 0, 1, 1, 1}}, {2.0, {0, 0, 0, 0, 0, 2.0 * degrees, 1, 1, 1}}}),
                 1.0);
  };
  for (const double degrees : {360.0, 600.0}) EXPECT_LT(spinning(degrees).second, 1e-3) << degrees;
  EXPECT_EQ(spinning(4.0 * 360.0).first, 128) << "at each quarter it is as it was";
}

}  // namespace
}  // namespace becalm::tracer::test
