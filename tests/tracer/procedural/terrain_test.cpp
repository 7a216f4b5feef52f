#include "tracer/procedural/terrain.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/tracer/procedural/fields.h"

namespace becalm::tracer::test {
namespace {

TEST(Terrain, BakesTheSameOnAnyNumberOfThreads) {
  const TerrainShape shape{3, 4.0f, 9, 1.0f, 256};
  std::vector<float> alone;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    alone = make_mountains(shape);
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
  EXPECT_EQ(alone, make_mountains(shape));
}

TEST(Terrain, HasPeaksAndValleysOfTheHeightAskedFor) {
  for (const std::uint32_t seed : {0u, 1u, 2u, 3u}) {
    TerrainDescription description = small_terrain(1.0);
    description.seed = seed;
    Terrain terrain;
    terrain.update(description, 0.0);
    const Imath::Box3f box = terrain.bounds();
    EXPECT_GT(box.min.y, -0.1f * 0.25f) << seed;
    EXPECT_LT(box.max.y, 1.5f * 0.25f) << seed;
    EXPECT_GT(box.max.y - box.min.y, 0.4f * 0.25f) << seed;
  }
}

TEST(Terrain, HeightIsAScaleAndErosionBakesAgain) {
  TerrainDescription description = small_terrain(2.0);
  description.height = Curve<1>({{0, {0.0}}, {2, {0.5}}}, Interpolation::linear);
  Terrain terrain;
  EXPECT_TRUE(terrain.update(description, 1.0));
  EXPECT_FALSE(terrain.update(description, 1.0));
  const float half = terrain.point(V3f(0.3f, 0.0f, 0.1f), 0.0f).position.y;
  EXPECT_TRUE(terrain.update(description, 2.0));
  EXPECT_FLOAT_EQ(terrain.point(V3f(0.3f, 0.0f, 0.1f), 0.0f).position.y, 2.0f * half);
  description.erosion = constant(0.2);
  EXPECT_TRUE(terrain.update(description, 2.0));
  EXPECT_NE(terrain.point(V3f(0.3f, 0.0f, 0.1f), 0.0f).position.y, 2.0f * half);
  EXPECT_TRUE(terrain.update(description, 0.0));
  const auto t = terrain.intersect(V3f(0.3f, 2.0f, 0.2f), V3f(0.0f, -1.0f, 0.0f), 0.0f, 10.0f);
  ASSERT_TRUE(t) << "of no height at all";
  EXPECT_NEAR(*t, 2.0f, 1e-5f);
}

TEST(Terrain, AWideFootprintSmoothsTheNormalAndReportsTheRest) {
  Terrain terrain;
  terrain.update(small_terrain(1.0), 0.0);
  const auto squared_slope = [](const V3f& n) { return (n.x * n.x + n.z * n.z) / (n.y * n.y); };
  double all = 0.0, kept[3] = {}, reported[3] = {};
  const float footprints[3] = {0.01f, 0.04f, 10.0f};
  constexpr int kSide = 200;
  for (int k = 0; k < kSide * kSide; ++k) {
    const V3f p((k % kSide + 0.5f) / kSide - 0.5f, 0.0f, (k / kSide + 0.5f) / kSide - 0.5f);
    const ProceduralPoint fine = terrain.point(p, 0.0f);
    EXPECT_EQ(fine.slope_variance, 0.0f);
    all += squared_slope(fine.normal);
    for (int f = 0; f < 3; ++f) {
      const ProceduralPoint wide = terrain.point(p, footprints[f]);
      EXPECT_EQ(fine.position, wide.position);
      kept[f] += squared_slope(wide.normal);
      reported[f] += wide.slope_variance;
    }
  }
  for (int f = 0; f < 3; ++f) EXPECT_NEAR((kept[f] + reported[f]) / all, 1.0, 0.15) << footprints[f];
  EXPECT_LT(kept[0] / all, 0.98);
  EXPECT_LT(kept[1], kept[0]);
  EXPECT_LT(kept[2] / all, 0.3);
}

}  // namespace
}  // namespace becalm::tracer::test
