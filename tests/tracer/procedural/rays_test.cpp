#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <sstream>

#include "tests/tracer/procedural/fields.h"

// Every kind of ray against each field, judged by dense sampling in double: before a hit the ray is on the
// side where it started, at the hit it is on the surface, and without a hit it never changes sides.

namespace becalm::tracer::test {
namespace {

constexpr int kSamples = 1000;

/// Signed distance-like value of a field: vertical for height fields.
double field_at(const Procedural& procedural, const ProceduralDescription& description, const V3d& p) {
  if (const auto* blobs = std::get_if<Blobs>(&procedural)) {
    const auto& d = std::get<BlobsDescription>(description);
    double sum = 0.0;
    for (int i = 0; i < d.count; ++i) {
      const V3f c = blobs->centre(i);
      sum += std::exp(-((p - V3d(c.x, c.y, c.z)).length() - double(blobs->radius(i))) / d.blend);
    }
    return -d.blend * std::log(sum);
  }
  return p.y - double(point(procedural, V3f(p)).position.y);
}

struct TestRay {
  V3f origin, dir;
  float t_min = 0.0f, t_max = 1e30f;
  V3d at(double t) const { return V3d(origin.x, origin.y, origin.z) + t * V3d(dir.x, dir.y, dir.z); }
};

/// Where the ray is over a height field's square, or near the blobs.
std::pair<double, double> interval(const Imath::Box3f& box, const TestRay& ray, bool heights) {
  double t0 = ray.t_min, t1 = ray.t_max;
  for (int axis = 0; axis < 3; ++axis) {
    // Twice as high as the bounds, so that what they leave out is seen.
    const double middle = 0.5 * (double(box.min[axis]) + box.max[axis]);
    const double half = 0.5 * (double(box.max[axis]) - box.min[axis]) * (heights && axis != 1 ? 1.0 : 2.0);
    const double o = ray.origin[axis], d = ray.dir[axis];
    if (d == 0.0) {
      if (std::abs(o - middle) > half) return {1.0, 0.0};
      continue;
    }
    const double a = (middle - half - o) / d, b = (middle + half - o) / d;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  return {t0, t1};
}

struct Judged {
  int hits = 0, misses = 0;
};

void judge(const NamedField& field, const Procedural& procedural, const TestRay& ray, double tolerance,
           Judged& judged) {
  const bool heights = !std::holds_alternative<Blobs>(procedural);
  const auto [t0, t1] = interval(bounds(procedural), ray, heights);
  const auto t = intersect(procedural, ray.origin, ray.dir, ray.t_min, ray.t_max);
  const auto what = [&] {
    std::ostringstream text;
    text.precision(9);
    text << field.name << " of size " << field.size << ", origin " << ray.origin << ", dir " << ray.dir
         << ", hit at " << (t ? *t : -1.0f) << " in " << t0 << ".." << t1;
    return text.str();
  };
  const auto value = [&](double s) { return field_at(procedural, field.description, ray.at(s)); };
  if (!(t0 < t1)) {
    ASSERT_FALSE(t) << what();
    return;
  }
  const double slack = 1e-6 * (t1 - t0);  // samples beside the square's border are not in it
  const double start = value(t0 + slack), sign = start >= 0.0 ? 1.0 : -1.0;
  if (std::abs(start) < tolerance) return;  // enters on the surface
  if (t) {
    ++judged.hits;
    ASSERT_GE(*t, ray.t_min) << what();
    ASSERT_LE(*t, ray.t_max) << what();
    ASSERT_LT(std::abs(value(*t)), tolerance) << what();
  } else {
    ++judged.misses;
  }
  const double end = t ? std::min(double(*t), t1 - slack) : t1 - slack;
  for (int k = 0; k < kSamples; ++k) {
    const double s = t0 + slack + (end - t0 - slack) * (k + 0.5) / kSamples;
    ASSERT_GT(sign * value(s), -tolerance) << what() << ": passed the surface at " << s;
  }
}

constexpr double kTolerance = 2e-6;  ///< in sizes

class Rays : public testing::TestWithParam<double> {
 protected:
  void for_fields(const std::function<void(const NamedField&, const Procedural&)>& body) {
    for (const NamedField& field : small_fields(GetParam())) body(field, made(field.description));
  }
  V3f in_box(float grow) {
    return V3f(random_.between(-0.5f, 0.5f), random_.between(-0.25f, 0.25f), random_.between(-0.5f, 0.5f)) *
           grow * static_cast<float>(GetParam());
  }
  V3f direction() {
    return V3f(random_.between(-1.0f, 1.0f), random_.between(-1.0f, 1.0f), random_.between(-1.0f, 1.0f))
        .normalized();
  }
  Random random_{42};
};

TEST_P(Rays, FromAnywhereToAnywhere) {
  const float size = static_cast<float>(GetParam());
  for_fields([&](const NamedField& field, const Procedural& procedural) {
    Judged judged;
    for (int k = 0; k < 300; ++k) {
      const V3f origin = in_box(k % 3 == 0 ? 4.0f : 1.0f);
      judge(field, procedural, {origin, (in_box(1.0f) - origin) * 0.37f}, kTolerance * size, judged);
      judge(field, procedural, {origin, direction() * 1e-3f}, kTolerance * size, judged);
      judge(field, procedural, {origin, direction() * size, 0.1f, 0.4f}, kTolerance * size, judged);
    }
    EXPECT_GT(judged.hits, 100) << field.name;
    EXPECT_GT(judged.misses, 50) << field.name;
  });
}

TEST_P(Rays, GrazingVerticalAndAlongAxes) {
  const float size = static_cast<float>(GetParam());
  for_fields([&](const NamedField& field, const Procedural& procedural) {
    const Imath::Box3f box = bounds(procedural);
    Judged judged;
    for (int k = 0; k < 150; ++k) {
      V3f origin = in_box(1.0f);
      origin.y = random_.between(box.min.y, box.max.y);
      judge(field, procedural, {origin, V3f(0.0f, k % 2 ? 1.0f : -1.0f, 0.0f) * size}, kTolerance * size,
            judged);
      judge(field, procedural, {origin, V3f(k % 2 ? 1.0f : -1.0f, 0.0f, 0.0f)}, kTolerance * size, judged);
      judge(field, procedural, {origin, V3f(0.0f, 0.0f, k % 2 ? 1.0f : -1.0f)}, kTolerance * size, judged);
      V3f flat = direction();
      flat.y *= 0.02f;
      origin -= flat * size;
      judge(field, procedural, {origin, flat}, kTolerance * size, judged);
      // Along the lines between cells.
      judge(field, procedural, {V3f(0.0f, origin.y, -size), V3f(0.0f, 0.001f, 1.0f)}, kTolerance * size,
            judged);
      judge(field, procedural, {V3f(0.25f * size, 2.0f * size, 0.125f * size), V3f(0.0f, -1.0f, 0.0f)},
            kTolerance * size, judged);
    }
    EXPECT_GT(judged.hits, 100) << field.name;
  });
}

TEST_P(Rays, ThatLeaveTheSurfaceDoNotMeetItAtOnce) {
  const float size = static_cast<float>(GetParam());
  for_fields([&](const NamedField& field, const Procedural& procedural) {
    Judged judged;
    int left = 0;
    for (int k = 0; k < 400; ++k) {
      V3f origin = in_box(1.0f);
      origin.y = 0.6f * size;
      const V3f dir = in_box(0.9f) - origin;
      const auto t = intersect(procedural, origin, dir, 0.0f, 1e30f);
      if (!t) continue;
      ++left;
      const ProceduralPoint p = point(procedural, origin + *t * dir);
      ASSERT_LT((p.position - (origin + *t * dir)).length(), 1e-5f * size) << field.name;
      // Off both sides, into all directions of that side, the flattest included.
      const float side = k % 2 ? 1.0f : -1.0f;
      V3f away = direction();
      if (away.dot(p.normal) * side < 0.0f) away = -away;
      if (k % 4 >= 2) away = (away - (away.dot(p.normal) - 0.01f * side) * p.normal).normalized();
      const V3f start = p.position + side * p.error * p.normal;
      // Where the start stands, it must be clear of what counts as on the surface: else the ray is not
      // judged.
      ASSERT_GT(side * field_at(procedural, field.description, V3d(start.x, start.y, start.z)),
                kTolerance * size)
          << field.name;
      judge(field, procedural, {start, away * 0.3f}, kTolerance * size, judged);
    }
    EXPECT_GT(left, 50) << field.name;
    EXPECT_GT(judged.misses, 20) << field.name;
    EXPECT_GT(judged.hits, 20) << field.name;
  });
}

TEST_P(Rays, FromFarAway) {
  const float size = static_cast<float>(GetParam());
  for_fields([&](const NamedField& field, const Procedural& procedural) {
    Judged judged;
    for (int k = 0; k < 150; ++k) {
      V3f origin = direction() * (1e4f * size);
      const V3f dir = (in_box(0.9f) - origin).normalized();
      // t itself is rounded to 5e-4 sizes there.
      judge(field, procedural, {origin, dir}, 3e-3 * size, judged);
      // However far, the point itself is exact.
      if (const auto t = intersect(procedural, origin, dir, 0.0f, 1e30f)) {
        const ProceduralPoint p = point(procedural, origin + *t * dir);
        ASSERT_LT(
            std::abs(field_at(procedural, field.description, V3d(p.position.x, p.position.y, p.position.z))),
            kTolerance * size);
      }
    }
    EXPECT_GT(judged.hits, 30) << field.name;
  });
}

TEST_P(Rays, NormalsAreTheFieldsGradient) {
  const double size = GetParam(), h = 1e-3 * size;
  for_fields([&](const NamedField& field, const Procedural& procedural) {
    int points = 0;
    double sum = 0.0;
    for (int k = 0; k < 600; ++k) {
      V3f origin = in_box(0.95f);
      origin.y = static_cast<float>(size);
      const V3f dir(0.0f, -1.0f, 0.0f);
      const auto t = intersect(procedural, origin, dir, 0.0f, 1e30f);
      if (!t) continue;
      ++points;
      const ProceduralPoint p = point(procedural, origin + *t * dir);
      ASSERT_NEAR(p.normal.length(), 1.0f, 1e-5f);
      V3d gradient;
      for (int axis = 0; axis < 3; ++axis) {
        V3d step(0.0);
        step[axis] = h;
        const V3d centre(p.position.x, p.position.y, p.position.z);
        gradient[axis] = field_at(procedural, field.description, centre + step) -
                         field_at(procedural, field.description, centre - step);
      }
      const double off = (gradient.normalized() - V3d(p.normal.x, p.normal.y, p.normal.z)).length();
      ASSERT_LT(off, 0.2) << field.name;  // a spline's second derivative jumps
      sum += off;
    }
    ASSERT_GT(points, 100) << field.name;
    EXPECT_LT(sum / points, 0.01) << field.name;
  });
}

INSTANTIATE_TEST_SUITE_P(Sizes, Rays, testing::Values(1e-4, 1.0, 1e6));

TEST(Procedural, BoundsHoldAHeightFieldAndAreTight) {
  for (const NamedField& field : small_fields(3.0)) {
    if (field.name == "blobs") continue;  // no height field
    const Procedural procedural = made(field.description);
    const Imath::Box3f box = bounds(procedural);
    Imath::Box3f seen;
    for (int k = 0; k < 90000; ++k) {
      // The surface itself, not what rays find of it, which are clipped to the box.
      const V3f at(3.0f * (static_cast<float>(k % 300) / 299.0f - 0.5f), 0.0f,
                   3.0f * (static_cast<float>(k / 300) / 299.0f - 0.5f));
      seen.extendBy(point(procedural, at).position);
    }
    EXPECT_TRUE(box.intersects(seen.min) && box.intersects(seen.max)) << field.name;
    const V3f size = box.size();
    EXPECT_LT(box.max.y - seen.max.y, 0.15f * size.y) << field.name;
    EXPECT_LT(seen.min.y - box.min.y, 0.15f * size.y) << field.name;
    EXPECT_FLOAT_EQ(size.x, 3.0f);
  }
}

TEST(Procedural, RaysThatAreNoneMeetNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  for (const NamedField& field : small_fields(1.0)) {
    const Procedural procedural = made(field.description);
    const V3f above(0.05f, 2.0f, 0.05f), down(0.0f, -1.0f, 0.0f);
    ASSERT_TRUE(intersect(procedural, above, down, 0.0f, infinity)) << field.name;
    EXPECT_TRUE(intersect(procedural, above, down * 1e-30f, 0.0f, infinity)) << field.name;
    EXPECT_TRUE(intersect(procedural, above, down * 1e30f, 0.0f, infinity)) << field.name;
    EXPECT_FALSE(intersect(procedural, above, -down, 0.0f, infinity)) << field.name;
    for (const float bad : {nan, infinity, -infinity}) {
      for (int axis = 0; axis < 3; ++axis) {
        V3f origin = above, dir = down;
        origin[axis] = bad;
        EXPECT_FALSE(intersect(procedural, origin, down, 0.0f, infinity)) << field.name;
        dir[axis] = bad;
        EXPECT_FALSE(intersect(procedural, above, dir, 0.0f, infinity)) << field.name;
      }
    }
    EXPECT_FALSE(intersect(procedural, above, V3f(0.0f), 0.0f, infinity)) << field.name;
    EXPECT_FALSE(intersect(procedural, above, down, nan, infinity)) << field.name;
    EXPECT_FALSE(intersect(procedural, above, down, 0.0f, nan)) << field.name;
    EXPECT_FALSE(intersect(procedural, above, down, 3.0f, 2.0f)) << field.name;
  }
}

TEST(Procedural, UpdateChangesKindAndReportsMemory) {
  Procedural procedural;
  EXPECT_TRUE(update(small_terrain(1.0), 0.0, procedural));
  EXPECT_GT(bytes(procedural), std::size_t{128 * 128 * 4});
  EXPECT_TRUE(update(small_blobs(1.0), 0.0, procedural));
  EXPECT_TRUE(std::holds_alternative<Blobs>(procedural));
  EXPECT_FALSE(update(small_blobs(1.0), 0.0, procedural));
}

}  // namespace
}  // namespace becalm::tracer::test
