// AOVs of configurations whose values follow from geometry. Samples lie at the pixel centres.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frame/error.h"
#include "tests/tracer/everything_scene.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/camera.h"

namespace becalm::tracer::test::aov_test {
namespace {

constexpr int kWidth = 40, kHeight = 30;
constexpr double kFov = 50.0;
const double kFocal = 0.5 * kHeight / std::tan(0.5 * kFov * std::numbers::pi / 180.0);

std::string scene(const std::string& look_at, const std::string& objects, const std::string& more = "") {
  return "{'film': {'width': 40, 'height': 30, " + std::string(kPointFilter) + "}, " + more +
         "'camera': {'fov_y_deg': 50, 'look_at': " + look_at + R"(},
    'materials': {
      'white': {'type': 'diffuse', 'reflectance': [0.8,0.6,0.4]}, 'red': {'type': 'diffuse', 'reflectance': [0.5,0.1,0.2]},
      'mirror': {'type': 'conductor', 'reflectance': [1,0.5,0.25]}, 'glass': {'type': 'dielectric', 'ior': 1},
      'crown': {'type': 'dielectric', 'ior': 1.5},
      'metal': {'type': 'conductor', 'reflectance': [0.9,0.6,0.3], 'roughness': 0.4}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'sphere', 'segments': 128}, 'box': {'shape': 'cube'}},
    'objects': [)" +
         objects + "]}";
}

const std::string kAhead = "{'eye': [0,0,0], 'target': [0,0,-1]}";
/// A plane at z = -4 that faces the camera and fills the picture.
const std::string kWall =
    "{'mesh': 'plane', 'material': 'white', 'transform': {'scale': 20, 'rotate_deg': [90,0,0], 'translate': "
    "[0,0,-4]}}";

/// A mirror, glass and a moving ball before the wall, each seen through a pixel's whole width.
std::string scene_of_mirrors() {
  std::string json =
      scene(kAhead,
            kWall +
                ", {'mesh': 'ball', 'material': 'mirror', 'transform': {'translate': [-1,0,-3]}}"
                ", {'mesh': 'ball', 'material': 'crown', 'transform': {'translate': [1,0,-3]}}"
                ", {'mesh': 'box', 'material': 'red', 'transform': {'scale': 0.3, 'translate': [0,0.8,-2]}}");
  const std::string narrow = "'radius_px': 0";
  return json.replace(json.find(narrow), narrow.size(), "'radius_px': 0.5");
}

Frame render(const std::string& json, int frame = 1, int spp = 2) {
  Scene scene = load_text(json);
  return render_frame(scene, frame, options(spp, {Aov::albedo, Aov::normal, Aov::depth, Aov::motion}))
      .value();
}

template <class Check>
void for_each_pixel(const Check& check) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) check(x, y);
  }
}

V3f pixel3(const Frame& frame, Aov aov, int x, int y) {
  const auto p = frame.image(aov).pixel(x, y);
  return {p[0], p[1], p[2]};
}
void expect_near(const V3f& value, const V3f& truth, float tolerance) {
  EXPECT_NEAR((value - truth).length(), 0.0f, tolerance) << value << " instead of " << truth;
}

TEST(Aov, WallHasNormalDepthAndAlbedo) {
  const Frame frame = render(scene(kAhead, kWall));
  for_each_pixel([&](int x, int y) {
    expect_near(pixel3(frame, Aov::normal, x, y), V3f(0, 0, 1), 1e-6f);
    expect_near(pixel3(frame, Aov::albedo, x, y), V3f(0.8f, 0.6f, 0.4f), 1e-6f);
    const double dx = (x + 0.5 - 0.5 * kWidth) / kFocal, dy = (y + 0.5 - 0.5 * kHeight) / kFocal;
    EXPECT_NEAR(frame.image(Aov::depth).at(x, y, 0), 4.0 * std::sqrt(1.0 + dx * dx + dy * dy), 1e-5);
    EXPECT_EQ(frame.image(Aov::motion).at(x, y, 0), 0.0f) << "nothing moves: exactly none";
    EXPECT_EQ(frame.image(Aov::motion).at(x, y, 1), 0.0f);
    EXPECT_EQ(frame.image(Aov::beauty).at(x, y, 3), 1.0f);
  });
}

TEST(Aov, NormalsFaceTheCameraAndAreInterpolated) {
  const Frame frame =
      render(scene("{'eye': [0,0,5], 'target': [0,0,0]}", "{'mesh': 'ball', 'material': 'metal'}"), 1, 1);
  for_each_pixel([&](int x, int y) {
    const double dx = (x + 0.5 - 0.5 * kWidth) / kFocal, dy = -(y + 0.5 - 0.5 * kHeight) / kFocal;
    const V3d dir = V3d(dx, dy, -1.0).normalized();
    const double b = 5.0 * dir.z, discriminant = b * b - 24.0;
    if (discriminant < 0.3) return;  // the facets' outline lies inside the sphere's
    const V3d p = V3d(0, 0, 5) + dir * (-b - std::sqrt(discriminant));
    expect_near(pixel3(frame, Aov::normal, x, y), V3f(p), 0.02f);
    expect_near(pixel3(frame, Aov::albedo, x, y), V3f(0.9f, 0.6f, 0.3f), 1e-3f);
  });
}

TEST(Aov, NormalsOfStretchedAndTurnedSpheresAreThoseOfTheEllipsoid) {
  const Frame frame = render(scene("{'eye': [0,0,5], 'target': [0,0,0]}",
                                   "{'mesh': 'ball', 'material': 'metal', 'transform': {'scale': [2,1,0.5], "
                                   "'rotate_deg': [0,0,30]}}"),
                             1, 1);
  const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
  int hits = 0;
  for_each_pixel([&](int x, int y) {
    if (frame.image(Aov::beauty).at(x, y, 3) == 0.0f) return;
    const double dx = (x + 0.5 - 0.5 * kWidth) / kFocal, dy = -(y + 0.5 - 0.5 * kHeight) / kFocal;
    const V3d p = V3d(0, 0, 5) + V3d(dx, dy, -1.0).normalized() * double(frame.image(Aov::depth).at(x, y, 0));
    const V3d local(c * p.x + s * p.y, -s * p.x + c * p.y, p.z);
    const V3d gradient(local.x / 4.0, local.y, local.z / 0.25);
    const V3d normal(c * gradient.x - s * gradient.y, s * gradient.x + c * gradient.y, gradient.z);
    expect_near(pixel3(frame, Aov::normal, x, y), V3f(normal.normalized()), 0.03f);
    ++hits;
  });
  EXPECT_GT(hits, 50);
}

TEST(Aov, NothingHitHasTheTablesValues) {
  const Frame frame = render(scene(kAhead, ""));
  for_each_pixel([&](int x, int y) {
    EXPECT_EQ(pixel3(frame, Aov::albedo, x, y), V3f(1));
    EXPECT_EQ(pixel3(frame, Aov::normal, x, y), V3f(0));
    EXPECT_EQ(frame.image(Aov::depth).at(x, y, 0), std::numeric_limits<float>::infinity());
    EXPECT_EQ(frame.image(Aov::beauty).at(x, y, 3), 0.0f);
  });
  const Frame sky = render(scene(kAhead, "", "'environment': {'radiance': [1,2,3]}, "));
  for_each_pixel([&](int x, int y) {
    EXPECT_EQ(pixel3(sky, Aov::beauty, x, y), V3f(1, 2, 3));
    EXPECT_EQ(sky.image(Aov::beauty).at(x, y, 3), 1.0f);
  });
}

TEST(Aov, MotionOfAMovingWall) {
  // From frame 1 to 2 the wall moves by (0.3, -0.2, 0) at distance 4: back by that in the picture, y down.
  const Frame frame = render(scene(kAhead, R"({'mesh': 'plane', 'material': 'white', 'transform': {'keys': [
      {'frame': 1, 'scale': 20, 'rotate_deg': [90,0,0], 'translate': [0,0,-4]},
      {'frame': 2, 'scale': 20, 'rotate_deg': [90,0,0], 'translate': [0.3,-0.2,-4]}]}})"),
                             2);
  for_each_pixel([&](int x, int y) {
    EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 0), -0.3 / 4.0 * kFocal, 1e-3);
    EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 1), -0.2 / 4.0 * kFocal, 1e-3);
  });
}

TEST(Aov, MotionOfATurningAndGrowingWall) {
  // Turned by 10 degrees about the view and scaled by 1.25: the previous position is turned and shrunk back.
  const Frame frame = render(scene(kAhead, R"({'mesh': 'plane', 'material': 'white', 'transform': {'keys': [
      {'frame': 1, 'scale': 20, 'rotate_deg': [90,0,0], 'translate': [0,0,-4]},
      {'frame': 2, 'scale': 25, 'rotate_deg': [90,0,10], 'translate': [0,0,-4]}]}})"),
                             2);
  const double c = std::cos(10 * std::numbers::pi / 180) / 1.25,
               s = std::sin(10 * std::numbers::pi / 180) / 1.25;
  for_each_pixel([&](int x, int y) {
    const double px = x + 0.5 - 0.5 * kWidth, py = 0.5 * kHeight - (y + 0.5);  // y up
    EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 0), (c * px + s * py) - px, 1e-3);
    EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 1), -((-s * px + c * py) - py), 1e-3);
  });
}

TEST(Aov, MotionOfABlurredWallThatTurnedMoreInTheFrameBefore) {
  // At whatever time of the shutter the sample is, the point was as far from the axis a frame before.
  const std::string shutter = "'shutter': [0,1], ";
  std::string json = scene(kAhead, R"({'mesh': 'plane', 'material': 'white', 'transform': {'keys': [
      {'frame': 1, 'scale': 20, 'rotate_deg': [90,0,0], 'translate': [0,0,-4]},
      {'frame': 2, 'scale': 20, 'rotate_deg': [90,0,180], 'translate': [0,0,-4]},
      {'frame': 3, 'scale': 20, 'rotate_deg': [90,0,183], 'translate': [0,0,-4]}]}})");
  const std::string camera = "'camera': {";
  json.replace(json.find(camera), camera.size(), camera + shutter);
  const Frame frame = render(json, 2, 1);
  for_each_pixel([&](int x, int y) {
    const double px = x + 0.5 - 0.5 * kWidth, py = y + 0.5 - 0.5 * kHeight;
    const double previous_x = px + frame.image(Aov::motion).at(x, y, 0);
    const double previous_y = py + frame.image(Aov::motion).at(x, y, 1);
    EXPECT_NEAR(std::hypot(previous_x, previous_y) / std::hypot(px, py), 1.0, 0.005);
  });
}

TEST(Aov, MotionOfAPanningCameraAtInfinityAndOfATravellingOne) {
  // The camera turns by 5 degrees to the right about y: what it sees moves left, and so came from the right.
  const double angle = 5.0 * std::numbers::pi / 180.0;
  const std::string look_at =
      "{'keys': [{'frame': 1, 'eye': [0,0,0], 'target': [0,0,-1]}, {'frame': 2, 'eye': [0,0,0], 'target': [" +
      std::to_string(std::sin(angle)) + ",0," + std::to_string(-std::cos(angle)) + "]}]}";
  const Frame frame = render(scene(look_at, ""), 2);
  for_each_pixel([&](int x, int y) {
    const double px = (x + 0.5 - 0.5 * kWidth) / kFocal, py = (y + 0.5 - 0.5 * kHeight) / kFocal;
    const double depth = std::cos(angle) - px * std::sin(angle);
    const double previous_x = (px * std::cos(angle) + std::sin(angle)) / depth, previous_y = py / depth;
    EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 0), (previous_x - px) * kFocal, 1e-3);
    EXPECT_NEAR(frame.image(Aov::motion).at(x, y, 1), (previous_y - py) * kFocal, 1e-3);
  });
  const Frame travelling =
      render(scene("{'keys': [{'frame': 1, 'eye': [0,0,0], 'target': [0,0,-1]}, {'frame': 2, 'eye': "
                   "[0.5,0,0], 'target': [0.5,0,-1]}]}",
                   kWall),
             2);
  for_each_pixel([&](int x, int y) {
    EXPECT_NEAR(travelling.image(Aov::motion).at(x, y, 0), 0.5 / 4.0 * kFocal, 1e-3);
    EXPECT_NEAR(travelling.image(Aov::motion).at(x, y, 1), 0.0, 1e-3);
  });
}

TEST(Aov, MotionOfATravellingCameraWhoseShutterIsOpen) {
  // Each sample is compared with where the camera was a frame before its own time. With steps of 0.2 and 0.4
  // those at the shutter's opening have moved by 0.2, those at its end by 0.4.
  const auto travelling = [](double second, double third, int spp) {
    const auto key = [](int frame, double x) {
      return fmt::format("{{'frame': {}, 'eye': [{},0,0], 'target': [{},0,-1]}}", frame, x, x);
    };
    std::string json = scene(fmt::format("{{'interpolation': 'linear', 'keys': [{}, {}, {}]}}", key(1, 0.0),
                                         key(2, second), key(3, third)),
                             kWall);
    const std::string camera = "'camera': {";
    json.replace(json.find(camera), camera.size(), camera + "'shutter': [0,1], ");
    return render(json, 2, spp);
  };
  const Frame even = travelling(0.3, 0.6, 2);
  for_each_pixel([&](int x, int y) {
    EXPECT_NEAR(even.image(Aov::motion).at(x, y, 0), 0.3 / 4.0 * kFocal, 1e-3);
    EXPECT_NEAR(even.image(Aov::motion).at(x, y, 1), 0.0, 1e-3);
  });
  const Frame faster = travelling(0.2, 0.6, 1);
  double sum = 0.0;
  for_each_pixel([&](int x, int y) {
    const double moved = faster.image(Aov::motion).at(x, y, 0) * 4.0 / kFocal;
    EXPECT_GT(moved, 0.2 - 1e-4);
    EXPECT_LT(moved, 0.4 + 1e-4);
    sum += moved / (kWidth * kHeight);
  });
  EXPECT_NEAR(sum, 0.3, 0.01);
}

TEST(Aov, WhatWasBehindThePreviousCameraCountsAsUnmoved) {
  const Frame frame = render(
      scene("{'keys': [{'frame': 1, 'eye': [0,0,-9], 'target': [0,0,-10]}, {'frame': 2, 'eye': [0,0,0], "
            "'target': [0,0,-1]}]}",
            kWall),
      2);
  for_each_pixel([&](int x, int y) { EXPECT_EQ(frame.image(Aov::motion).at(x, y, 0), 0.0f); });
}

TEST(Aov, AlbedoAndNormalAreFollowedThroughMirrors) {
  // The camera looks at a mirror that shows the red wall behind the camera.
  const Frame frame = render(scene(kAhead, R"(
      {'mesh': 'plane', 'material': 'mirror', 'transform': {'scale': 9, 'rotate_deg': [90,0,0], 'translate': [0,0,-2]}},
      {'mesh': 'plane', 'material': 'red', 'transform': {'scale': 90, 'rotate_deg': [-90,0,0], 'translate': [0,0,3]}})"));
  for_each_pixel([&](int x, int y) {
    // The mirror's tint is part of what a filter divides out; it grows towards grazing angles.
    const V3f albedo = pixel3(frame, Aov::albedo, x, y);
    EXPECT_NEAR(albedo.x, 0.5f, 1e-4f);
    EXPECT_NEAR(albedo.y, 0.05f, 0.01f);
    EXPECT_NEAR(albedo.z, 0.05f, 0.01f);
    expect_near(pixel3(frame, Aov::normal, x, y), V3f(0, 0, -1), 1e-5f);
    EXPECT_LT(frame.image(Aov::depth).at(x, y, 0), 3.0f) << "depth is the mirror's own";
  });
}

TEST(Aov, AlbedoAndNormalAreFollowedThroughGlass) {
  // Glass of index 1 lets everything pass straight.
  const Frame frame = render(scene(
      kAhead,
      "{'mesh': 'ball', 'material': 'glass', 'transform': {'scale': 0.5, 'translate': [0,0,-2]}}, " + kWall));
  for_each_pixel([&](int x, int y) {
    expect_near(pixel3(frame, Aov::albedo, x, y), V3f(0.8f, 0.6f, 0.4f), 1e-5f);
    expect_near(pixel3(frame, Aov::normal, x, y), V3f(0, 0, 1), 1e-5f);
  });
  EXPECT_NEAR(frame.image(Aov::depth).at(kWidth / 2, kHeight / 2, 0), 1.5f, 1e-2f);
}

TEST(Aov, AlbedoInsideGlassIsThatOfTheSurface) {
  // Radiance shrinks by 1/1.5^2 where it enters the block; reflectance does not. What the block reflects sees
  // nothing and counts as 1.
  const Frame frame = render(
      scene(kAhead,
            "{'mesh': 'box', 'material': 'crown', 'transform': {'scale': 30, 'translate': [0,0,-31]}}, " +
                kWall),
      1, 16);
  V3f mean(0.0f);
  for_each_pixel([&](int x, int y) { mean += pixel3(frame, Aov::albedo, x, y) / float(kWidth * kHeight); });
  const float reflected = 0.043f;  // unpolarised, averaged over the picture's angles of up to 31 degrees
  expect_near(mean, V3f(0.8f, 0.6f, 0.4f) * (1.0f - reflected) + V3f(reflected), 0.01f);
}

TEST(Aov, MirrorsThatShowNothingGiveTheirTint) {
  const Frame frame = render(scene(kAhead,
                                   "{'mesh': 'plane', 'material': 'mirror', 'transform': {'scale': 9, "
                                   "'rotate_deg': [90,0,0], 'translate': [0,0,-2]}}"));
  const V3f albedo = pixel3(frame, Aov::albedo, kWidth / 2, kHeight / 2);
  expect_near(albedo, V3f(1, 0.5f, 0.25f), 2e-3f);
  EXPECT_EQ(pixel3(frame, Aov::normal, kWidth / 2, kHeight / 2), V3f(0));
}

TEST(Aov, ExistOnlyWhenAskedForAndChangeNothing) {
  const std::string json =
      scene("{'eye': [0,0,5], 'target': [0,0,0]}", "{'mesh': 'ball', 'material': 'mirror'}, " + kWall,
            "'environment': {'radiance': 1}, ");
  Scene scene = load_text(json);
  const Frame plain = render_frame(scene, 1, options(4)).value();
  EXPECT_EQ(plain.aovs().count(), 1u);
  const Frame all = render_frame(scene, 1,
                                 options(4, {Aov::albedo, Aov::normal, Aov::depth, Aov::motion, Aov::variance,
                                             Aov::half_a, Aov::half_b, Aov::flow}))
                        .value();
  EXPECT_EQ(all.aovs().count(), 8u) << "the diagnostics are the filter's";
  for (std::size_t i = 0; i < plain.image(Aov::beauty).data().size(); ++i) {
    ASSERT_EQ(plain.image(Aov::beauty).data()[i], all.image(Aov::beauty).data()[i]);
  }
  for_each_pixel([&](int x, int y) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(0.5f * (all.image(Aov::half_a).at(x, y, c) + all.image(Aov::half_b).at(x, y, c)),
                  all.image(Aov::beauty).at(x, y, c), 1e-6f);
    }
  });
}

TEST(Camera, ProjectsWhereItLooks) {
  const Camera camera({{1, 2, 3}, {4, 1, -2}, {0.2, 1, 0}}, 65.0, 123, 45);
  for (const V2f& raster : {V2f(0.5f, 0.5f), V2f(61.5f, 22.5f), V2f(120.25f, 3.0f), V2f(-4.0f, 50.0f)}) {
    const Ray ray = camera.ray(raster);
    EXPECT_NEAR(ray.dir.length(), 1.0f, 1e-6f);
    const V2d again = camera.project(V3d(ray.origin) + V3d(ray.dir) * 7.0).value();
    EXPECT_NEAR(again.x, raster.x, 1e-4);
    EXPECT_NEAR(again.y, raster.y, 1e-4);
    EXPECT_FALSE(camera.project(V3d(ray.origin) - V3d(ray.dir)).has_value());
  }
}

const auto kSeen = {Aov::albedo, Aov::normal, Aov::depth, Aov::motion, Aov::object_id, Aov::material_id};

void expect_equal(const Frame& a, const Frame& b, std::initializer_list<Aov> aovs) {
  for (const Aov aov : aovs)
    EXPECT_TRUE(std::ranges::equal(a.image(aov).data(), b.image(aov).data())) << info(aov).name;
}

/// Nine samples of what is seen beside two of the radiance, against nine of both.
void expect_samples_of_more_paths(Scene scene, std::initializer_list<Aov> compared) {
  RenderOptions o = options(2, kSeen);
  o.aov_spp = 9;
  const Frame frame = render_frame(scene, 2, o).value();
  const Frame truth = render_frame(scene, 2, options(9, kSeen)).value();
  expect_equal(frame, truth, compared);
}

TEST(AovSamples, AreThoseThatMorePathsWouldGive) {
  expect_samples_of_more_paths(load_text(scene_of_mirrors()), kSeen);
}

TEST(AovSamples, ReachWhatFogLetsThrough) {
  // Not the albedo: textures are averaged over a ninth of a pixel where nine paths look it up, not two.
  expect_samples_of_more_paths(load_text(everything_scene()),
                               {Aov::depth, Aov::motion, Aov::object_id, Aov::material_id});
}

TEST(AovSamples, LeaveTheRadianceAlone) {
  const auto radiances = {Aov::variance, Aov::half_a, Aov::half_b, Aov::direct, Aov::indirect, Aov::albedo};
  Scene scene = load_text(everything_scene());
  RenderOptions o = options(2, radiances);
  const Frame before = render_frame(scene, 2, o).value();
  o.aov_spp = 9;
  const Frame after = render_frame(scene, 2, o).value();
  expect_equal(after, before,
               {Aov::beauty, Aov::variance, Aov::half_a, Aov::half_b, Aov::direct, Aov::indirect});
  EXPECT_FALSE(std::ranges::equal(after.image(Aov::albedo).data(), before.image(Aov::albedo).data()));
}

TEST(AovSamples, OutOfRangeIsAUsageError) {
  Scene scene = load_text(scene_of_mirrors());
  RenderOptions o = options(2, kSeen);
  for (const int wrong : {-1, 65537}) {
    o.aov_spp = wrong;
    EXPECT_THROW(render_frame(scene, 1, o), Error) << wrong;
  }
}

}  // namespace
}  // namespace becalm::tracer::test::aov_test
