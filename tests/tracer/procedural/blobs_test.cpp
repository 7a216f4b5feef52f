#include "tracer/procedural/blobs.h"

#include <gtest/gtest.h>

#include "tests/tracer/procedural/fields.h"

namespace becalm::tracer::test {
namespace {

TEST(Blobs, OneBallIsASphere) {
  for (const float size : {1e-4f, 1.0f, 1e6f}) {
    BlobsDescription description = small_blobs(size);
    description.count = 1;
    Blobs blobs;
    blobs.update(description, 0.0);
    const V3f centre = blobs.centre(0);
    const float radius = blobs.radius(0);
    const Imath::Box3f box = blobs.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(box.min[axis], centre[axis] - radius, 1e-5f * size);
      EXPECT_NEAR(box.max[axis], centre[axis] + radius, 1e-5f * size);
    }
    Random random(1);
    int hits = 0;
    for (int k = 0; k < 20000; ++k) {
      // Every other ray starts inside.
      const float from = k % 2 == 0 ? 2.0f : 0.5f;
      const V3f origin =
          centre + radius * from * V3f(random() - 0.5f, random() - 0.5f, random() - 0.5f).normalized();
      const V3f dir = (V3f(random() - 0.5f, random() - 0.5f, random() - 0.5f).normalized() * 1.7f) * size;
      // |o + t d|^2 = r^2
      const V3d o((origin - centre).x, (origin - centre).y, (origin - centre).z), d(dir.x, dir.y, dir.z);
      const double a = d.dot(d), b = o.dot(d), c = o.dot(o) - double(radius) * radius, disc = b * b - a * c;
      if (std::abs(disc) < 1e-4 * a * radius * radius) continue;  // grazes: float cannot tell
      const auto t = blobs.intersect(origin, dir, 0.0f, 1e30f);
      const bool expected = disc > 0.0 && (c < 0.0 || b < 0.0);
      ASSERT_EQ(t.has_value(), expected) << k << " size " << size;
      if (!t) continue;
      ++hits;
      const double exact = ((c < 0.0 ? 1.0 : -1.0) * std::sqrt(disc) - b) / a;
      ASSERT_NEAR(*t, exact, 2e-4 * radius / size) << k;
      const ProceduralPoint p = blobs.point(origin + *t * dir, 0.0f);
      ASSERT_NEAR((p.position - centre).length(), radius, p.error) << k;
      ASSERT_LT((p.normal - (p.position - centre).normalized()).length(), 1e-4f) << k;
    }
    EXPECT_GT(hits, 10000);
  }
}

TEST(Blobs, MoveContinuouslyAndOnlyWithTime) {
  BlobsDescription description = small_blobs(1.0);
  description.time_s = Curve<1>({{0, {0}}, {24, {1}}}, Interpolation::linear);
  Blobs blobs;
  EXPECT_TRUE(blobs.update(description, 3.0));
  EXPECT_FALSE(blobs.update(description, 3.0));
  const V3f before = blobs.centre(4);
  EXPECT_TRUE(blobs.update(description, 4.0));
  const float moved = (blobs.centre(4) - before).length();
  EXPECT_GT(moved, 1e-5f);
  // At most 1.5 speed turns / s of a circle as wide as the extent.
  EXPECT_LT(moved, 1.5 * description.speed * 2.0 * 3.15 * description.extent / 24.0);
}

}  // namespace
}  // namespace becalm::tracer::test
