// Pairs of eyes: the off-axis camera against projections made by hand, and what the frames of a pair share.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/camera_animation.h"

namespace becalm::tracer::test {
namespace {

/// A camera at (0,0,5) that looks along -z, 200x100 px, film at 100 px: tan(fov/2) = 50 / 100.
CameraSettings settings_with(double separation, std::optional<double> convergence = std::nullopt) {
  CameraSettings settings;
  settings.fov_y_deg = 2.0 * std::atan(0.5) * 180.0 / std::numbers::pi;
  settings.eye_separation = Curve<1>::Value{separation};
  if (convergence) settings.convergence_distance = Curve<1>::Value{*convergence};
  return settings;
}

Camera eye_at(const CameraSettings& settings, Eye eye) {
  return camera_at(settings, 1.0, 200, 100, eye);
}

TEST(StereoCamera, SeesPointsWhereTheyAreByHand) {
  const CameraSettings settings = settings_with(0.4, 4.0);
  const Camera left = eye_at(settings, Eye::left), right = eye_at(settings, Eye::right);
  EXPECT_EQ(left.eye(), V3f(-0.2f, 0, 5));
  EXPECT_EQ(right.eye(), V3f(0.2f, 0, 5));
  // z = 2 along the view: from the left eye 0.2 + 0.3 to the right, so at 100 * 0.5 / 2 = 25 px from its
  // axis, which lies 100 * 0.2 / 4 = 5 px to the left of the middle.
  const V2d in_left = *left.project({0.3, 0.1, 3});
  EXPECT_NEAR(in_left.x, 100 - 5 + 25, 1e-9);
  EXPECT_NEAR(in_left.y, 50 - 5, 1e-9);
  const V2d in_right = *right.project({0.3, 0.1, 3});
  EXPECT_NEAR(in_right.x, 100 + 5 + 5, 1e-9);
  EXPECT_NEAR(in_right.y, 50 - 5, 1e-9) << "no disparity along y";
}

TEST(StereoCamera, DisparityFollowsFromTheDepth) {
  for (const double convergence : {1.5, 4.0, 1e6}) {
    const CameraSettings settings = settings_with(0.065, convergence);
    const Camera left = eye_at(settings, Eye::left), right = eye_at(settings, Eye::right);
    const StereoCamera pair = *stereo_camera_at(settings, 1.0, 200, 100);
    EXPECT_NEAR(pair.focal_px, 100.0, 1e-9);
    for (const double z : {0.5, 1.5, 4.0, 100.0}) {
      const V3d point(0.2, -0.1, 5 - z);
      const double disparity = left.project(point)->x - right.project(point)->x;
      EXPECT_NEAR(disparity, 100.0 * 0.065 * (1 / z - 1 / convergence), 1e-9);
      EXPECT_NEAR(disparity, pair.disparity_px(z), 1e-9);
      EXPECT_TRUE(z != convergence || std::abs(disparity) < 1e-12) << z;
    }
    EXPECT_NEAR(left.project_direction({0, 0, -1})->x - right.project_direction({0, 0, -1})->x,
                pair.disparity_px(std::numeric_limits<double>::infinity()), 1e-9);
  }
}

TEST(StereoCamera, ConvergesWhereItFocusesUnlessToldOtherwise) {
  CameraSettings settings = settings_with(0.1);
  EXPECT_NEAR(stereo_camera_at(settings, 1.0, 200, 100)->convergence, 5.0, 1e-12) << "the target's distance";
  settings.focus_distance = Curve<1>::Value{3.0};
  EXPECT_NEAR(stereo_camera_at(settings, 1.0, 200, 100)->convergence, 3.0, 1e-12);
  settings.convergence_distance = Curve<1>::Value{2.0};
  EXPECT_NEAR(stereo_camera_at(settings, 1.0, 200, 100)->convergence, 2.0, 1e-12);
  settings.eye_separation.reset();
  EXPECT_FALSE(stereo_camera_at(settings, 1.0, 200, 100));
}

TEST(StereoCamera, RaysLeadToWhatIsProjected) {
  const CameraSettings settings = settings_with(0.3, 2.0);
  for (const Eye eye : {Eye::left, Eye::right}) {
    const Camera camera = eye_at(settings, eye);
    const StereoView view{*stereo_camera_at(settings, 1.0, 200, 100), eye};
    for (const V2f& raster : {V2f(3.5f, 90.25f), V2f(100, 50), V2f(180, 7)}) {
      const Ray ray = camera.ray(raster);
      const V2d back = *camera.project(V3d(ray.origin) + V3d(ray.dir) * 7.0);
      EXPECT_NEAR(back.x, raster.x, 1e-3);
      EXPECT_NEAR(back.y, raster.y, 1e-3);
      EXPECT_NEAR(view.cosine(raster.x, raster.y, 200, 100), -ray.dir.z, 1e-6);
    }
  }
}

std::string scene_with(const std::string& eyes) {
  return "{'film': {'width': 24, 'height': 16}, 'camera': {" + eyes +
         R"('look_at': {'eye': [0,1,4], 'target': [0,0.5,0]}}, 'environment': {'radiance': 0.2},
    'materials': {'clay': {'type': 'diffuse', 'reflectance': 0.6}}, 'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'sphere'}},
    'objects': [{'mesh': 'plane', 'material': 'clay', 'transform': {'scale': 4}},
                {'mesh': 'plane', 'material': 'clay', 'emission': 5, 'transform': {'scale': 0.5, 'rotate_deg': [180,0,0], 'translate': [0,3,0]}},
                {'mesh': 'ball', 'material': 'clay', 'transform': {'scale': 0.5, 'translate': [0,0.5,0]}}]})";
}

Frame of_eye(const std::string& scene_text, Eye eye) {
  Scene scene = load_text(scene_text);
  RenderOptions asked = options(4, {Aov::depth, Aov::motion});
  asked.eye = eye;
  return render_frame(scene, 1, asked).value();
}

bool same(const Frame& a, const Frame& b, Aov aov) {
  return std::ranges::equal(a.image(aov).data(), b.image(aov).data());
}

TEST(StereoRender, EyesHaveNoiseOfTheirOwnAndNothingElseChanges) {
  const std::string together = scene_with("'eye_separation': 0, ");
  const Frame mono = of_eye(scene_with(""), Eye::centre);
  const Frame left = of_eye(together, Eye::left), right = of_eye(together, Eye::right);
  EXPECT_FALSE(mono.stereo());
  EXPECT_TRUE(same(mono, of_eye(together, Eye::centre), Aov::beauty)) << "without an eye, the camera between";
  EXPECT_TRUE(same(mono, left, Aov::beauty)) << "the left eye's random numbers are those of a single view";
  EXPECT_FALSE(same(left, right, Aov::beauty));
  ASSERT_TRUE(right.stereo());
  EXPECT_EQ(right.stereo()->eye, Eye::right);
}

TEST(StereoRender, BadCamerasAreNamed) {
  EXPECT_NE(load_error(scene_with("'eye_separation': -1, ")).find("/camera/eye_separation"),
            std::string::npos);
  EXPECT_NE(load_error(scene_with("'eye_separation': 0.1, 'convergence_distance': 0, "))
                .find("/camera/convergence_distance"),
            std::string::npos);
  EXPECT_NE(load_error(scene_with("'convergence_distance': 2, ")).find("eye_separation"), std::string::npos);
}

}  // namespace
}  // namespace becalm::tracer::test
