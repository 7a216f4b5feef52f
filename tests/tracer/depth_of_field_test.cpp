// The thin lens: circles of confusion, the aperture's shape, what is in focus.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tracer/shading/statistics.h"
#include "tests/tracer/test_scenes.h"
#include "tracer/camera.h"

namespace becalm::tracer::test::depth_of_field_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSize = 33;
constexpr double kFocalPx = 100.0;
constexpr double kDistance = 8.0;  // of the small lamp, along the view
constexpr double kHalfWidthPx = 1.0;

/// A small square lamp ahead, seen through that lens.
Frame lamp_seen_through(const std::string& lens, int spp) {
  const double fov_deg = 2.0 * std::atan(0.5 * kSize / kFocalPx) * 180.0 / kPi;
  const double half_width = kHalfWidthPx * kDistance / kFocalPx;
  Scene scene = load_text(
      "{'film': {'width': 33, 'height': 33, " + std::string(kPointFilter) +
      "}, 'integrator': {'max_depth': 0}, 'camera': {'fov_y_deg': " + std::to_string(fov_deg) + ", " + lens +
      R"(, 'look_at': {'eye': [0,0,8], 'target': [0,0,0]}},
    'materials': {'black': {'type': 'diffuse', 'reflectance': 0}}, 'meshes': {'plane': {'shape': 'rectangle'}},
    'objects': [{'mesh': 'plane', 'material': 'black', 'emission': 1, 'transform': {'rotate_deg': [90,0,0], 'scale': )" +
      std::to_string(half_width) + "}}]}");
  EXPECT_TRUE(scene.needs().depth_of_field);
  return render_frame(scene, 1, options(spp)).value();
}

/// Radius in pixels over which the thin lens spreads a point at distance d when focused at f:
/// aperture_radius |1/d - 1/f| times the film's distance.
double confusion_radius_px(double aperture_radius, double focus) {
  return kFocalPx * aperture_radius * std::abs(1.0 / kDistance - 1.0 / focus);
}

TEST(DepthOfField, SpreadsAPointUniformlyOverItsCircleOfConfusion) {
  for (const double focus : {4.0, 1e6}) {
    const double aperture = 0.96;
    const double radius = confusion_radius_px(aperture, focus);
    ASSERT_NEAR(radius, 12.0, 0.01);
    const Frame frame =
        lamp_seen_through("'aperture_radius': 0.96, 'focus_distance': " + std::to_string(focus), 1024);
    // Where the square lies wholly within the lens as the pixel sees it, its share is that of the areas.
    const double expected = 4.0 * kHalfWidthPx * kHalfWidthPx / (kPi * radius * radius);
    const double reach = std::sqrt(2.0) * kHalfWidthPx;
    double ring_sum[3] = {0, 0, 0}, ring_count[3] = {0, 0, 0}, total = 0.0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const double distance = std::hypot(x + 0.5 - 0.5 * kSize, y + 0.5 - 0.5 * kSize);
        const double value = frame.image(Aov::beauty).at(x, y, 0);
        total += value;
        if (distance > radius + reach + 1e-3) {
          EXPECT_EQ(value, 0.0) << x << "," << y;
        }
        if (distance > radius - reach - 1e-3) continue;
        const int ring = static_cast<int>(3.0 * distance / (radius - reach));
        ring_sum[ring] += value;
        ring_count[ring] += 1.0;
      }
    }
    for (int ring = 0; ring < 3; ++ring) {
      // Less than binomial, since the samples are stratified over the lens.
      const double error = std::sqrt(expected / (1024.0 * ring_count[ring]));
      EXPECT_NEAR(ring_sum[ring] / ring_count[ring], expected, 4.0 * error) << "ring " << ring;
    }
    EXPECT_NEAR(total, 4.0 * kHalfWidthPx * kHalfWidthPx, 0.05) << "the lens loses and adds nothing";
  }
}

TEST(DepthOfField, FocusIsSharp) {
  const Frame frame = lamp_seen_through("'aperture_radius': 0.96, 'focus_distance': 8", 64);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double dx = std::abs(x + 0.5 - 0.5 * kSize), dy = std::abs(y + 0.5 - 0.5 * kSize);
      if (std::max(dx, dy) == 1.0) continue;  // on the lamp's edge
      EXPECT_EQ(frame.image(Aov::beauty).at(x, y, 0), std::max(dx, dy) < kHalfWidthPx ? 1.0f : 0.0f)
          << x << "," << y;
    }
  }
}

TEST(DepthOfField, FocusesOnTheTargetByDefault) {
  const Frame by_default = lamp_seen_through("'aperture_radius': 0.5", 4);
  const Frame stated = lamp_seen_through("'aperture_radius': 0.5, 'focus_distance': 8", 4);
  const Frame elsewhere = lamp_seen_through("'aperture_radius': 0.5, 'focus_distance': 7", 4);
  bool differs = false;
  for (std::size_t i = 0; i < by_default.image(Aov::beauty).data().size(); ++i) {
    ASSERT_EQ(by_default.image(Aov::beauty).data()[i], stated.image(Aov::beauty).data()[i]);
    differs = differs || by_default.image(Aov::beauty).data()[i] != elsewhere.image(Aov::beauty).data()[i];
  }
  EXPECT_TRUE(differs);
}

TEST(DepthOfField, BladesShapeTheConfusion) {
  // Behind the focus a lens with a triangular aperture, its first corner to the right, spreads a point over
  // that triangle the same way round; in front of it, over the triangle turned by half a turn.
  for (const bool behind : {false, true}) {
    const Frame frame = lamp_seen_through(
        std::string("'aperture_radius': 0.96, 'blades': 3, 'focus_distance': ") + (behind ? "4" : "1e6"),
        256);
    // Beyond the triangle's flat side, at cos(60 deg) = half the radius, nothing; towards its corner, light.
    const int corner = behind ? 1 : -1;
    const double middle = 0.5 * kSize;
    double towards_corner = 0.0, beyond_side = 0.0;
    for (int y = 14; y <= 18; ++y) {
      for (int d = 8; d <= 9; ++d) {
        towards_corner += frame.image(Aov::beauty).at(static_cast<int>(middle + corner * d), y, 0);
        beyond_side += frame.image(Aov::beauty).at(static_cast<int>(middle - corner * d), y, 0);
      }
    }
    // A point P at the depth d is seen at the raster position where the lens point p lets it pass:
    // r = focal (P/d - p (1/d - 1/f)): along +p where the focus is nearer than the point.
    EXPECT_GT(towards_corner, 0.0) << behind;
    EXPECT_EQ(beyond_side, 0.0) << behind;
  }
}

/// The aperture in coordinates in which it is uniform: for discs (angle, squared distance), for polygons
/// (side and way along it, squared distance from the centre relative to the side's).
Chart aperture_chart(int blades, float rotation) {
  Chart chart;
  const double step = blades < 3 ? 2.0 * kPi : 2.0 * kPi / blades;
  chart.domain = {0.0, blades < 3 ? 1.0 : static_cast<double>(blades), 0.0, 1.0};
  chart.density = [width = chart.domain.x1](const V2d&) { return 1.0 / width; };
  chart.draw = [=](TestRandom& random) -> std::optional<V2d> {
    const V2d p(sample_aperture(blades, rotation, random.next_2d()));
    double angle = std::atan2(p.y, p.x) - rotation;
    angle -= 2.0 * kPi * std::floor(angle / (2.0 * kPi));
    if (blades < 3) return V2d(angle / (2.0 * kPi), std::min(p.dot(p), 1.0 - 1e-9));
    const double side = std::min(std::floor(angle / step), blades - 1.0);
    const double middle = rotation + (side + 0.5) * step;
    const double height = p.dot(V2d(std::cos(middle), std::sin(middle))) / std::cos(0.5 * step);
    const double along = p.dot(V2d(-std::sin(middle), std::cos(middle))) / (height * std::sin(0.5 * step));
    if (!(height <= 1.0 + 1e-6)) return std::nullopt;  // outside the polygon
    return V2d(side + std::clamp(0.5 + 0.5 * along, 0.0, 1.0 - 1e-9), std::min(height * height, 1.0 - 1e-9));
  };
  for (int i = 1; i < blades; ++i) chart.jumps_x.push_back(i);
  return chart;
}

TEST(Aperture, PointsAreUniform) {
  const struct {
    int blades;
    float rotation;
  } cases[] = {{0, 0.0f}, {3, 0.0f}, {5, 0.7f}, {6, -2.0f}, {64, 0.1f}};
  for (const auto& [blades, rotation] : cases) {
    const SamplerTest result = test_sampler(aperture_chart(blades, rotation), 7);
    EXPECT_NEAR(result.integral, 1.0, 1e-6);
    EXPECT_GT(result.result.p_value, sidak_level(0.01, 5)) << blades << " blades: " << result.replay;
  }
}

TEST(Aperture, StaysWithinTheUnitCircle) {
  for (const int blades : {0, 3, 8}) {
    for (const V2f& u :
         {V2f(0.0f), V2f(0.5f), V2f(0.99999994f), V2f(0.0f, 0.99999994f), V2f(0.99999994f, 0.0f)}) {
      const V2f p = sample_aperture(blades, 1.0f, u);
      EXPECT_LE(p.length(), 1.0f + 1e-6f) << blades << " " << u.x << " " << u.y;
      EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
    }
  }
}

}  // namespace
}  // namespace becalm::tracer::test::depth_of_field_test
