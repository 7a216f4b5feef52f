#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "tests/tracer/media/test_media.h"
#include "tracer/media/cloud_shape.h"
#include "tracer/media/gradient_noise.h"
#include "tracer/snapshot/update_medium.h"

namespace becalm::tracer {
namespace {

bool same_bits(const DensityGrid& a, const DensityGrid& b) {
  if (a.size() != b.size()) return false;
  for (int z = 0; z < a.size().z; ++z) {
    for (int y = 0; y < a.size().y; ++y) {
      for (int x = 0; x < a.size().x; ++x) {
        if (a.value(x, y, z) != b.value(x, y, z)) return false;
      }
    }
  }
  return true;
}

CloudShape small_cloud() {
  CloudShape shape;
  shape.resolution = {48, 24, 40};
  return shape;
}

/// Mean density of the grid's voxels.
double cover(const CloudShape& shape) {
  const DensityGrid grid = bake_cloud(shape);
  const V3i& size = grid.size();
  double sum = 0.0;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) sum += grid.value(x, y, z);
    }
  }
  return sum / (double(size.x) * size.y * size.z);
}

TEST(GradientNoise, IsContinuousBoundedAndCentred) {
  TestRandom random(60);
  MeanTest mean;
  float largest = 0.0f;
  for (int i = 0; i < 50000; ++i) {
    NoisePoint p;
    for (double& x : p) x = 200.0 * random.next() - 100.0;
    const float value = gradient_noise(p, 5);
    mean.add(value);
    largest = std::max(largest, std::abs(value));
    NoisePoint beside = p;
    beside[i % 4] += 1e-4;
    ASSERT_NEAR(gradient_noise(beside, 5), value, 1e-3);
    // Across a cell's face as well.
    p[i % 4] = std::round(p[i % 4]) - 1e-5;
    beside = p;
    beside[i % 4] += 2e-5;
    ASSERT_NEAR(gradient_noise(beside, 5), gradient_noise(p, 5), 1e-3);
  }
  EXPECT_LT(std::abs(mean.mean()), 0.01);
  EXPECT_GT(largest, 0.6f);
  EXPECT_LT(largest, 1.1f);
}

TEST(GradientNoise, HugeCoordinatesAreDefined) {
  for (const double x : {-1e15, -1e9, 1e9, 4e15}) {
    const float value = gradient_noise({x + 0.3, -x, 0.5, x}, 1);
    EXPECT_LT(std::abs(value), 1.1f);
  }
}

TEST(Cloud, BakesTheSameBitsWithAnyNumberOfThreads) {
  const auto bake = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return bake_cloud(small_cloud());
  };
  const DensityGrid one = bake(1);
  EXPECT_TRUE(same_bits(one, bake(2)));
  EXPECT_TRUE(same_bits(one, bake(7)));
  EXPECT_GT(one.largest(), 0.9f);
}

TEST(Cloud, IsEmptyAtTheBordersAndWithinUnit) {
  for (const float coverage : {0.0f, 0.5f, 1.0f}) {
    CloudShape shape = small_cloud();
    shape.coverage = coverage;
    const DensityGrid grid = bake_cloud(shape);
    const V3i last = grid.size() - V3i(1);
    for (int z = 0; z <= last.z; ++z) {
      for (int y = 0; y <= last.y; ++y) {
        for (int x = 0; x <= last.x; ++x) {
          const float value = grid.value(x, y, z);
          ASSERT_TRUE(value >= 0.0f && value <= 1.0f);
          const bool border = x == 0 || y == 0 || z == 0 || x == last.x || y == last.y || z == last.z;
          ASSERT_TRUE(!border || value == 0.0f) << x << " " << y << " " << z;
        }
      }
    }
  }
}

TEST(Cloud, CoverageFillsTheSky) {
  CloudShape shape = small_cloud();
  double before = -1.0;
  for (const float coverage : {0.0f, 0.3f, 0.6f, 1.0f}) {
    shape.coverage = coverage;
    const double filled = cover(shape);
    EXPECT_GT(filled, before) << "coverage " << coverage;
    before = filled;
  }
  shape.coverage = 0.0f;
  EXPECT_LT(cover(shape), 0.01);
}

/// Leaving out the octaves that cannot matter where a cloud is solid must not change a value. (Where it is
/// clear, what is left out is bounded by the noise's bound of 1.1, tested above.)
TEST(Cloud, SolidPartsEndEarlyAndExactly) {
  const CloudShape shape = small_cloud();
  CloudShape unhurried = shape;
  unhurried.softness = 100.0f;  // nothing is ever solid
  const CloudDensity density(shape), unhurried_density(unhurried);
  TestRandom random(61);
  int partial = 0;
  for (int i = 0; i < 20000; ++i) {
    // Above the base's ramp.
    const V3f p(random.next() - 0.5f, 0.9f * random.next() - 0.7f, random.next() - 0.5f);
    const float value = density(p);
    const float expected = unhurried_density(p) * unhurried.softness / shape.softness;
    ASSERT_NEAR(std::min(1.0f, expected), value, 1e-4f);
    partial += value > 0.0f && value < 1.0f ? 1 : 0;
  }
  EXPECT_GT(partial, 500);
}

TEST(Cloud, DriftMovesThePattern) {
  CloudShape shape = small_cloud();
  CloudShape moved = shape;
  moved.offset = V3f(0.1f, 0.0f, -0.05f);
  const CloudDensity density(shape), moved_density(moved);
  TestRandom random(62);
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    // Within the rim, where the pattern alone decides.
    const V3f p(0.8f * random.next() - 0.4f, random.next() - 0.8f, 0.8f * random.next() - 0.4f);
    const float value = density(p);
    inside += value > 0.0f ? 1 : 0;
    ASSERT_NEAR(moved_density(p + moved.offset), value, 1e-3f);
  }
  EXPECT_GT(inside, 500);
}

TEST(UpdateMedium, BakesOnlyWhatChanged) {
  CloudDescription cloud;
  cloud.shape = small_cloud();
  cloud.evolution = Curve<1>({{1.0, {0.0}}, {3.0, {1.0}}}, Interpolation::linear);
  cloud.extinction = Curve<1>({{5.0, {1.0}}, {6.0, {2.0}}}, Interpolation::linear);
  cloud.albedo = V3f(0.9f);
  cloud.g = 0.8f;
  const MediumDescription description = cloud;
  Medium medium;
  update_medium(description, 1.0, M44d(), medium);
  const auto& grid = std::get<GridMedium>(medium);
  EXPECT_EQ(bytes(medium), grid.density->bytes());
  EXPECT_GE(bytes(medium), 48u * 24u * 40u * 4u);
  EXPECT_EQ(mean_cosine(medium), 0.8f);
  const std::shared_ptr<const DensityGrid> first = grid.density;

  update_medium(description, 2.0, M44d(), medium);
  EXPECT_EQ(grid.baked_shape.evolution, 0.5f);
  EXPECT_FALSE(same_bits(*grid.density, *first));

  update_medium(description, 4.0, M44d(), medium);
  const std::shared_ptr<const DensityGrid> held = grid.density;
  std::get<GridMedium>(medium).density = first;  // would be replaced by a bake
  update_medium(description, 6.0, oblique_place(), medium);
  EXPECT_TRUE(same_bits(*grid.density, *first));
  EXPECT_FALSE(same_bits(*held, *first));
  EXPECT_EQ(grid.extinction, 2.0f);
  const V3f corner =
      transform_point(V3f(transform_point(V3d(1, 1, -1), oblique_place())), grid.world_to_voxels);
  EXPECT_NEAR((corner - V3f(47, 23, 0)).length(), 0.0f, 1e-4f);

  const MediumDescription fog = HomogeneousMedium{V3f(1.0f), V3f(0.5f), 0.1f};
  update_medium(fog, 6.0, M44d(), medium);
  EXPECT_EQ(std::get<HomogeneousMedium>(medium), std::get<HomogeneousMedium>(fog));
  EXPECT_EQ(bytes(medium), 0u);
}

}  // namespace
}  // namespace becalm::tracer
