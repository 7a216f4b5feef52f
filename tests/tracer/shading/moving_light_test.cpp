// Emitters that move during the shutter interval are, at each time, what static ones there would be.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/tracer/shading/statistics.h"
#include "tracer/lights/lights.h"

namespace becalm::tracer {
namespace {

const V3f kPoint(0.2f, -1.0f, 0.3f);

V3f between(const V3f& a, const V3f& b, float t) {
  return a * (1.0f - t) + b * t;
}

/// Compares samples of lights with a single emitter: the moving one at `time` and a static one.
void expect_same_samples(const Lights& moving, float time, const Lights& still) {
  TestRandom random(60);
  int found = 0;
  for (int i = 0; i < 100; ++i) {
    const V2f u = random.next_2d();
    const auto a = moving.sample(moving.received(kPoint, time), 0.5f, u);
    const auto b = still.sample(still.received(kPoint, 0.0f), 0.5f, u);
    ASSERT_EQ(a.has_value(), b.has_value()) << time;
    if (!a) continue;
    ++found;
    ASSERT_EQ(a->dir_world, b->dir_world) << time;
    ASSERT_EQ(a->distance, b->distance) << time;
    ASSERT_EQ(a->radiance, b->radiance) << time;
    ASSERT_EQ(a->pdf_solid_angle, b->pdf_solid_angle) << time;
    ASSERT_EQ(a->group, b->group);
    ASSERT_EQ(a->delta, b->delta);
  }
  EXPECT_GT(found, 0) << time;
}

/// Times, and where they lie among three keys.
struct Moment {
  float time;
  std::size_t segment;
  float share;
};
const std::vector<Moment> kMoments = {{0.0f, 0, 0.0f},  {0.125f, 0, 0.25f}, {0.5f, 1, 0.0f},
                                      {0.75f, 1, 0.5f}, {1.0f, 1, 1.0f},    {1.5f, 1, 1.0f}};

TEST(MovingLight, triangle) {
  const std::vector<TriangleKey> keys = {{V3f(0, 1, 0), V3f(1, 1, 0), V3f(0, 1, 1)},
                                         {V3f(2, 2, 0), V3f(3, 1, 0), V3f(2, 1, 1)},
                                         {V3f(5, 2, 3), V3f(6, 4, 3), V3f(5, 3, 4)}};
  LightList list;
  // One that another emitter uses stands before its keys.
  list.triangle_keys = {{V3f(9), V3f(8), V3f(7)}, keys[0], keys[1], keys[2]};
  list.triangles = {{V3f(NAN), V3f(NAN), V3f(NAN), V3f(3.0f), true, 5, {1, 2}}};
  const Lights moving{list};
  for (const Moment& moment : kMoments) {
    const TriangleKey &a = keys[moment.segment], &b = keys[moment.segment + 1];
    LightList still;
    still.triangles = {{between(a[0], b[0], moment.share),
                        between(a[1], b[1], moment.share),
                        between(a[2], b[2], moment.share),
                        V3f(3.0f),
                        true,
                        5,
                        {}}};
    const Lights static_lights{still};
    expect_same_samples(moving, moment.time, static_lights);
    const auto drawn = moving.sample(moving.received(kPoint, moment.time), 0.5f, V2f(0.3f, 0.4f));
    ASSERT_TRUE(drawn);
    EXPECT_EQ(moving.pdf_triangle(0, moving.received(kPoint, moment.time), drawn->dir_world, drawn->distance),
              drawn->pdf_solid_angle);
  }
}

TEST(MovingLight, static_triangles_beside_moving_ones_stand_still) {
  LightList list;
  list.triangle_keys = {{V3f(0, 1, 0), V3f(1, 1, 0), V3f(0, 1, 1)},
                        {V3f(5, 1, 0), V3f(6, 1, 0), V3f(5, 1, 1)}};
  list.triangles = {{V3f(0), V3f(0), V3f(0), V3f(1e-30f), true, 0, {0, 1}},
                    {V3f(-3, 1, 0), V3f(-2, 1, 0), V3f(-3, 1, 1), V3f(1.0f), true, 0, {}}};
  const Lights lights{list};
  const auto at_start = lights.sample(lights.received(kPoint, 0.0f), 0.9f, V2f(0.2f, 0.6f));
  const auto at_end = lights.sample(lights.received(kPoint, 1.0f), 0.9f, V2f(0.2f, 0.6f));
  ASSERT_TRUE(at_start && at_end);
  EXPECT_EQ(at_start->radiance, V3f(1.0f));
  EXPECT_EQ(at_start->dir_world, at_end->dir_world);
}

TEST(MovingLight, sphere) {
  const std::vector<SphereKey> keys = {{V3f(0, 1, 0), 0.5f}, {V3f(3, 2, 0), 1.0f}, {V3f(3, 2, 5), 0.25f}};
  LightList list;
  list.sphere_keys = {{V3f(9), 9.0f}, keys[0], keys[1], keys[2]};
  list.spheres = {{V3f(NAN), NAN, V3f(3.0f), false, 7, {1, 2}}};
  const Lights moving{list};
  for (const Moment& moment : kMoments) {
    const SphereKey &a = keys[moment.segment], &b = keys[moment.segment + 1];
    LightList still;
    still.spheres = {{between(a.center, b.center, moment.share),
                      a.radius * (1.0f - moment.share) + b.radius * moment.share,
                      V3f(3.0f),
                      false,
                      7,
                      {}}};
    const Lights static_lights{still};
    expect_same_samples(moving, moment.time, static_lights);
    EXPECT_EQ(moving.pdf_sphere(0, moving.received(kPoint, moment.time)),
              static_lights.pdf_sphere(0, static_lights.received(kPoint, 0.0f)));
  }
}

TEST(MovingLight, point_and_spot) {
  const std::vector<SpotKey> keys = {
      {V3f(0, 1, 0), V3f(0, -1, 0)}, {V3f(1, 2, 0), V3f(-0.3f, -1, 0)}, {V3f(1, 2, 2), V3f(0, -1, -0.6f)}};
  LightList points, spots;
  points.points = {{V3f(NAN), V3f(3.0f), 1, {0, 2}}};
  points.point_keys = {keys[0].position, keys[1].position, keys[2].position};
  spots.spots = {{V3f(NAN), V3f(NAN), V3f(2.0f), 10.0f, 60.0f, 2, {0, 2}}};
  spots.spot_keys = keys;
  const Lights moving_point{points}, moving_spot{spots};
  for (const Moment& moment : kMoments) {
    const SpotKey &a = keys[moment.segment], &b = keys[moment.segment + 1];
    const V3f position = between(a.position, b.position, moment.share);
    LightList still_point, still_spot;
    still_point.points = {{position, V3f(3.0f), 1, {}}};
    still_spot.spots = {
        {position, between(a.direction, b.direction, moment.share), V3f(2.0f), 10.0f, 60.0f, 2, {}}};
    expect_same_samples(moving_point, moment.time, Lights{still_point});
    expect_same_samples(moving_spot, moment.time, Lights{still_spot});
  }
}

TEST(MovingLight, spots_without_a_direction_for_a_moment_are_dark_then) {
  LightList list;
  list.spots = {{V3f(0, 2, 0), V3f(0), V3f(1.0f), 150.0f, 180.0f, 0, {0, 1}}};
  list.spot_keys = {{V3f(0, 2, 0), V3f(0, -1, 0)}, {V3f(0, 2, 0), V3f(0, 1, 0)}};
  const Lights lights{list};
  EXPECT_TRUE(lights.sample(lights.received(kPoint, 0.25f), 0.5f, V2f(0.5f)));
  EXPECT_FALSE(lights.sample(lights.received(kPoint, 0.5f), 0.5f, V2f(0.5f)));
}

/// The share of samples that a sphere of varying size takes beside a static one of the same radiance.
TEST(MovingLight, is_chosen_by_what_it_sends_at_the_time) {
  LightList list;
  list.spheres = {{V3f(0, 5, 0), 1.0f, V3f(1.0f), false, 0, {}},
                  {V3f(5, 0, 0), 1.0f, V3f(1.0f), false, 0, {0, 2}}};
  list.sphere_keys = {{V3f(5, 0, 0), 0.0f}, {V3f(5, 0, 0), 2.0f}, {V3f(5, 0, 0), 1.0f}};
  const Lights lights{list};
  const EmissiveSphere still{V3f(0, 5, 0), 1.0f, V3f(1.0f), false, 0, {}};
  const EmissiveSphere then{V3f(5, 0, 0), 1.2f, V3f(1.0f), false, 0, {}};
  const double share =
      still.irradiance_at(kPoint) / (still.irradiance_at(kPoint) + then.irradiance_at(kPoint));
  EXPECT_NEAR(lights.pdf_sphere(0, lights.received(kPoint, 0.3f)) / still.pdf_solid_angle(kPoint), share,
              1e-6);
}

TEST(MovingLight, broken_keys_are_never_chosen) {
  LightList list;
  list.triangle_keys = {{V3f(0, 1, 0), V3f(1, 1, 0), V3f(0, 1, 1)}, {V3f(NAN), V3f(1, 1, 0), V3f(0, 1, 1)}};
  list.triangles = {{V3f(0), V3f(0), V3f(0), V3f(1.0f), true, 0, {0, 1}}};
  list.sphere_keys = {{V3f(0, 1, 0), 1.0f}, {V3f(INFINITY, 1, 0), 1.0f}};
  list.spheres = {{V3f(0), 0.0f, V3f(1.0f), true, 0, {0, 1}}};
  list.point_keys = {V3f(0), V3f(NAN)};
  list.points = {{V3f(0), V3f(1.0f), 0, {0, 1}}};
  list.spot_keys = {{V3f(0), V3f(0, 1, 0)}, {V3f(NAN), V3f(0, 1, 0)}};
  list.spots = {{V3f(0), V3f(0), V3f(1.0f), 10.0f, 20.0f, 0, {0, 1}}};
  EXPECT_TRUE(Lights{list}.empty());
}

}  // namespace
}  // namespace becalm::tracer
