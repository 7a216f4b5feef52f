// Spheres without triangles: where rays meet them, how they look, what they light.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/estimates.h"
#include "tests/tracer/shading/statistics.h"
#include "tracer/math/unit_sphere.h"

namespace becalm::tracer::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Both roots of |origin + t dir| = 1 in long double, and how far inside the sphere the ray passes.
struct Roots {
  double depth;  ///< 1 minus the squared distance of closest approach
  double nearer, farther;
};
Roots exact_roots(const V3f& origin, const V3f& dir) {
  using Real = long double;
  const Real o[3] = {origin.x, origin.y, origin.z}, d[3] = {dir.x, dir.y, dir.z};
  Real a = 0, b = 0, c = -1;
  for (int i = 0; i < 3; ++i) {
    a += d[i] * d[i];
    b += o[i] * d[i];
    c += o[i] * o[i];
  }
  const Real discriminant = b * b - a * c;
  const Real root = discriminant > 0 ? std::sqrt(discriminant) : Real(0);
  const Real larger = b > 0 ? -b - root : -b + root;  // no cancellation
  const Real other = larger != 0 ? c / larger : Real(0);
  const double t0 = static_cast<double>(larger / a), t1 = static_cast<double>(other);
  return {static_cast<double>(discriminant / a), std::min(t0, t1), std::max(t0, t1)};
}

V3f unit_vector(TestRandom& random) {
  for (;;) {
    const V3f v(2 * random.next() - 1, 2 * random.next() - 1, 2 * random.next() - 1);
    if (v.length2() < 1.0f && v.length2() > 0.01f) return v.normalized();
  }
}

TEST(UnitSphere, MeetsRaysWhereLongDoubleSays) {
  TestRandom random(3);
  int hits = 0, misses = 0, grazing = 0;
  for (int i = 0; i < 200000; ++i) {
    // Distances from 1e-4 to 1e4, aimed within two radii of the centre.
    const float distance = std::pow(10.0f, 8.0f * random.next() - 4.0f);
    const V3f origin = unit_vector(random) * distance;
    const V3f aim = unit_vector(random) * (2.0f * random.next());
    // Instances give directions of any length.
    const V3f dir = (aim - origin) * std::pow(10.0f, 6.0f * random.next() - 3.0f);
    const Roots exact = exact_roots(origin, dir);
    // What the coordinates' own rounding lets happen: the closest approach moves by that much.
    const double rounding = 4.0 * 0x1p-24 * std::max(1.0f, distance);
    const std::optional<LocalHit> hit = intersect_unit_sphere(origin, dir, kInfinity);
    if (std::abs(exact.depth) <= 8.0 * rounding) {
      ++grazing;
      continue;  // either answer is right
    }
    const double first = exact.nearer > 0.0 ? exact.nearer : exact.farther;
    const double length = dir.length();
    const double half_chord = std::sqrt(std::max(0.0, exact.depth));
    const bool expected = exact.depth > 0.0 && first > 0.0;
    if (exact.depth > 0.0 &&
        std::min(std::abs(exact.nearer), std::abs(exact.farther)) * length < 4.0 * rounding / half_chord)
      continue;  // the origin is on the surface: a test of its own
    ASSERT_EQ(hit.has_value(), expected) << i << ": distance " << distance << " depth " << exact.depth;
    ++(expected ? hits : misses);
    if (!expected) continue;
    // Across a grazing ray an error sideways becomes a longer one along it.
    EXPECT_NEAR(hit->distance * length, first * length, 4.0 * rounding * (1.0 + 1.0 / half_chord))
        << i << ": distance " << distance << " depth " << exact.depth;
  }
  EXPECT_GT(hits, 50000);
  EXPECT_GT(misses, 20000);
  EXPECT_LT(grazing, 2000);
}

TEST(UnitSphere, RaysThatLeaveTheSurfaceDoNotMeetItAgain) {
  TestRandom random(4);
  for (int i = 0; i < 100000; ++i) {
    const V3f normal = unit_vector(random);
    // Off the surface by the least that surface_at puts between them.
    const V3f outside = normal * (1.0f + 0x1p-20f), inside = normal * (1.0f - 0x1p-20f);
    V3f dir = unit_vector(random);
    if (i % 4 == 0) dir = (dir - normal * dir.dot(normal) * 0.9999f).normalized();  // grazing
    const float cos_angle = dir.dot(normal);
    const V3f outward = cos_angle < 0.0f ? -dir : dir;
    EXPECT_FALSE(intersect_unit_sphere(outside, outward, kInfinity)) << i;
    const std::optional<LocalHit> across = intersect_unit_sphere(inside, -outward, kInfinity);
    ASSERT_TRUE(across) << i;
    const Roots exact = exact_roots(inside, -outward);
    EXPECT_NEAR(across->distance, exact.farther, 4e-7 * (1.0 + 1.0 / std::sqrt(exact.depth))) << i;
  }
}

TEST(UnitSphere, IsMetByRaysOfTheSpaceOfAFlattenedOne) {
  // Rays onto its middle and around it, from three radii away, in the space of a sphere of this thickness.
  TestRandom random(5);
  for (const double thickness : {1e-2, 1e-6, 1e-9, 0x1p-40}) {
    for (int i = 0; i < 10000; ++i) {
      const float angle = 6.28318f * random.next(), radius = i % 2 == 0 ? 0.9f * random.next() : 1.1f;
      const V3d aim(radius * std::cos(angle), radius * std::sin(angle), 0.0), from(0.5, -1.0, 3.0);
      V3d dir = aim - from, origin = from;
      dir.z /= thickness;
      origin.z /= thickness;
      const std::optional<LocalHit> hit = intersect_unit_sphere(V3f(origin), V3f(dir), kInfinity);
      if (i % 2 == 1 && thickness > 1e-6) continue;  // a thick one's rim may be met
      ASSERT_EQ(hit.has_value(), i % 2 == 0) << "thickness " << thickness << " radius " << radius;
      if (!hit) continue;
      EXPECT_NEAR(hit->distance, 1.0f, 2.0 * thickness + 1e-6);
      EXPECT_NEAR(hit->point.length(), 1.0f, 1e-6);
      EXPECT_GT(hit->point.z, 0.0f) << "the side that faces the ray";
      EXPECT_NEAR((V3d(hit->point) - aim).x, 0.0, thickness + 1e-6);
      EXPECT_NEAR((V3d(hit->point) - aim).y, 0.0, thickness + 1e-6);
    }
  }
}

TEST(UnitSphere, RespectsTheRaysEnd) {
  const V3f origin(0, 0, 3), dir(0, 0, -2);
  EXPECT_FALSE(intersect_unit_sphere(origin, dir, 1.0f)) << "it is met at 1, and the end is open";
  const std::optional<LocalHit> outside = intersect_unit_sphere(origin, dir, 1.001f);
  ASSERT_TRUE(outside);
  EXPECT_EQ(outside->distance, 1.0f);
  EXPECT_EQ(outside->point, V3f(0, 0, 1));
  const std::optional<LocalHit> inside = intersect_unit_sphere(V3f(0), dir, kInfinity);
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->distance, 0.5f);
  EXPECT_EQ(inside->point, V3f(0, 0, -1));
  EXPECT_FALSE(intersect_unit_sphere(V3f(0, 0, -3), dir, kInfinity));
  EXPECT_FALSE(intersect_unit_sphere(origin, V3f(0), kInfinity));
}

std::string lit_ball(const std::string& mesh, const std::string& direct) {
  return R"({'film': {'width': 32, 'height': 32, 'filter': {'type': 'box', 'radius_px': 0}}, 'integrator': {'max_depth': 2, 'direct': ')" +
         direct + R"('},
    'camera': {'fov_y_deg': 20, 'look_at': {'eye': [1,2,8], 'target': [0,0.5,0]}}, 'environment': {'radiance': [0.3,0.4,0.5]},
    'lights': {'lamp': {'type': 'point', 'position': [3,4,5], 'intensity': 30}},
    'materials': {'m': {'type': 'principled', 'base_color': [0.8,0.5,0.3], 'roughness': 0.4}},
    'meshes': {'ball': )" +
         mesh + R"(, 'plane': {'shape': 'rectangle'}},
    'objects': [{'mesh': 'plane', 'material': 'm', 'transform': {'scale': 3, 'translate': [0,-1,0]}},
                {'mesh': 'ball', 'material': 'm', 'transform': {'scale': [1.2,0.9,1], 'rotate_deg': [10,20,30]}}]})";
}

TEST(ExactSphere, LooksLikeAFineMesh) {
  Scene exact = load_text(lit_ball("{'shape': 'exact_sphere'}", "mis"));
  Scene mesh = load_text(lit_ball("{'shape': 'sphere', 'segments': 1024}", "mis"));
  EXPECT_EQ(exact.needs().triangles, 2u);
  const auto o = options(1, {Aov::normal, Aov::depth});
  const Frame a = render_frame(exact, 1, o).value(), b = render_frame(mesh, 1, o).value();
  int ball = 0, silhouette = 0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const float depth_a = a.image(Aov::depth).at(x, y, 0), depth_b = b.image(Aov::depth).at(x, y, 0);
      if (std::isfinite(depth_a) != std::isfinite(depth_b) || std::abs(depth_a - depth_b) > 0.01f) {
        ++silhouette;
        continue;
      }
      if (!std::isfinite(depth_a)) continue;
      ball += a.image(Aov::normal).at(x, y, 1) < 0.999f;
      EXPECT_NEAR(depth_a, depth_b, 3e-4) << x << "," << y;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a.image(Aov::normal).at(x, y, c), b.image(Aov::normal).at(x, y, c), 6e-3)
            << x << "," << y;
    }
  }
  EXPECT_GT(ball, 200);
  EXPECT_LT(silhouette, 4);
  expect_same_expectation({"exact sphere", lit_ball("{'shape': 'exact_sphere'}", "mis"), 16, 12},
                          {"mesh", lit_ball("{'shape': 'sphere', 'segments': 1024}", "mis"), 16, 12, 500}, 4,
                          0.01, 2e-3);
}

TEST(ExactSphere, TurnsWhileItEmits) {
  write_uv_picture();
  const auto seen = [](const std::string& transform) {
    Scene scene = load_text(
        R"({'film': {'width': 16, 'height': 16, 'filter': {'type': 'box', 'radius_px': 0}},
      'camera': {'fov_y_deg': 20, 'look_at': {'eye': [1,2,8], 'target': [0,0,0]}},
      'materials': {'m': {'type': 'diffuse', 'reflectance': {'image': 'uv.ppm', 'space': 'linear'}}},
      'meshes': {'ball': {'shape': 'exact_sphere'}}, 'objects': [{'mesh': 'ball', 'material': 'm', 'emission': 1,
        'transform': )" +
        transform + "}]}");
    return render_frame(scene, 5, options(1, {Aov::albedo, Aov::motion})).value();
  };
  const Frame turning =
      seen("{'keys': [{'frame': 1, 'rotate_deg': [0,0,0]}, {'frame': 9, 'rotate_deg': [0,80,0]}]}");
  const Frame still = seen("{'rotate_deg': [0,40,0]}");
  for (std::size_t i = 0; i < still.image(Aov::albedo).data().size(); ++i)
    ASSERT_NEAR(turning.image(Aov::albedo).data()[i], still.image(Aov::albedo).data()[i], 1e-3f);
  EXPECT_LT(turning.image(Aov::motion).at(8, 8, 0), -0.5f) << "10 degrees to the right a frame";
  EXPECT_EQ(still.image(Aov::motion).at(8, 8, 0), 0.0f);
}

TEST(ExactSphere, CarriesTexturesAsTheMeshDoes) {
  const auto seen = [](const std::string& mesh) {
    write_uv_picture();
    Scene scene = load_text(
        R"({'film': {'width': 32, 'height': 32, 'filter': {'type': 'box', 'radius_px': 0}},
      'camera': {'fov_y_deg': 20, 'look_at': {'eye': [1,2,8], 'target': [0,0,0]}},
      'materials': {'m': {'type': 'diffuse', 'reflectance': {'image': 'uv.ppm', 'space': 'linear'}}}, 'meshes': {'ball': )" +
        mesh + "}, 'objects': [{'mesh': 'ball', 'material': 'm', 'transform': {'rotate_deg': [0,20,0]}}]}");
    return render_frame(scene, 1, options(1, {Aov::albedo})).value();
  };
  const Frame exact = seen("{'shape': 'exact_sphere'}"), mesh = seen("{'shape': 'sphere', 'segments': 512}");
  int different = 0;
  float least = 1.0f, most = 0.0f;
  for (std::size_t i = 0; i < exact.image(Aov::albedo).data().size(); ++i) {
    const float a = exact.image(Aov::albedo).data()[i], b = mesh.image(Aov::albedo).data()[i];
    different += std::abs(a - b) > 0.03f;
    least = std::min(least, a);
    most = std::max(most, a);
  }
  EXPECT_LT(different, 60) << "of 3072 values";
  EXPECT_LT(least, 0.2f);
  EXPECT_GT(most, 0.8f);
}

class SphereLamp : public testing::TestWithParam<const char*> {};

TEST_P(SphereLamp, GivesTheKnownIrradiance) {
  // Straight below a sphere of radius r at distance d: E = pi L (r/d)^2.
  Scene scene =
      load_text(R"({'film': {'width': 8, 'height': 8}, 'integrator': {'max_depth': 1, 'direct': ')" +
                std::string(GetParam()) + R"('},
    'camera': {'fov_y_deg': 0.01, 'look_at': {'eye': [3,1,0], 'target': [0,0,0]}},
    'materials': {'grey': {'type': 'diffuse', 'reflectance': 0.6}},
    'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'exact_sphere'}},
    'objects': [{'mesh': 'plane', 'material': 'grey'},
      {'mesh': 'ball', 'material': 'grey', 'emission': 7, 'transform': {'scale': -0.75, 'translate': [0,1.5,0]}}]})");
  const Mean mean = mean_radiance(render_frame(scene, 1, options(1024, {Aov::variance})).value());
  const double truth = 0.6 * 7.0 * 0.25;
  EXPECT_LT(mean.error, 0.01 * truth);
  EXPECT_NEAR(mean.value, truth, 4.0 * mean.error + 1e-5);
}

INSTANTIATE_TEST_SUITE_P(ExactSphere, SphereLamp, testing::Values("mis", "light", "material"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(SphereLamp, DoesNotLightItselfFromOutside) {
  // A convex lamp in the dark shows its emission, and what passes through it: 1 where nothing does.
  for (const char* object : {"'material': 'grey', 'two_sided': true",
                             "'material': 'metal', 'two_sided': true", "'material': 'frosted'"}) {
    for (const int away : {0, 100}) {
      const std::string x = std::to_string(away);
      Scene scene =
          load_text("{'film': {'width': 16, 'height': 16}, 'integrator': {'max_depth': 8, 'direct': '" +
                    std::string(GetParam()) + "'}, 'camera': {'fov_y_deg': 5, 'look_at': {'eye': [" + x +
                    ",0,5], 'target': [" + x + R"(,0,0]}},
          'materials': {'grey': {'type': 'diffuse', 'reflectance': 0.5},
            'metal': {'type': 'conductor', 'reflectance': 0.9, 'roughness': 0.5},
            'frosted': {'type': 'dielectric', 'ior': 1.5, 'roughness': 0.5}},
          'meshes': {'ball': {'shape': 'exact_sphere'}},
          'objects': [{'mesh': 'ball', 'emission': 1, 'transform': {'translate': [)" +
                    x + ",0,0]}, " + object + "}]}");
      const Mean mean = mean_radiance(render_frame(scene, 1, options(64, {Aov::variance})).value());
      EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.error + 1e-5) << object << " at " << away;
    }
  }
}

TEST(ExactSphere, HasNoAcneAtAnySize) {
  // A convex white body in a uniform sky shows exactly the sky, unless a ray finds its own surface again.
  for (const double unit : {1e-4, 1.0, 1e6}) {
    for (const char* keys : {"", ", 'keys'"}) {
      char camera[200], place[200];
      std::snprintf(camera, sizeof camera, "{'eye': [%.9g,%.9g,%.9g], 'target': [0,%.9g,0]}", unit, 2 * unit,
                    4 * unit, 0.1 * unit);
      std::snprintf(place, sizeof place,
                    "'scale': [%.9g,%.9g,%.9g], 'rotate_deg': [10,20,30], 'translate': [0,%.9g,0]", unit,
                    0.7 * unit, 1.1 * unit, 0.1 * unit);
      const std::string transform = *keys == 0 ? "{" + std::string(place) + "}"
                                               : "{'keys': [{'frame': 1, " + std::string(place) +
                                                     "}, {'frame': 2, 'translate': [1,0,0]}]}";
      Scene scene = load_text(
          "{'film': {'width': 48, 'height': 48}, 'integrator': {'max_depth': 1, 'direct': 'material'},"
          "'environment': {'radiance': 1}, 'camera': {'fov_y_deg': 30, 'look_at': " +
          std::string(camera) +
          "}, 'materials': {'white': {'type': 'diffuse', 'reflectance': 1}}, 'meshes': {'ball': {'shape': "
          "'exact_sphere'}}, 'objects': [{'mesh': 'ball', 'material': 'white', 'transform': " +
          transform + "}]}");
      const Frame frame = render_frame(scene, 1, options(16)).value();
      int dark = 0;
      for (int i = 0; i < 48 * 48; ++i)
        dark += std::abs(frame.image(Aov::beauty).data()[4 * i] - 1.0f) > 1e-5f;
      EXPECT_EQ(dark, 0) << "unit " << unit << (*keys == 0 ? " static" : " moving");
    }
  }
}

}  // namespace
}  // namespace becalm::tracer::test
