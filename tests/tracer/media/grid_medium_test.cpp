#include "tracer/media/grid_medium.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "tests/tracer/media/test_media.h"
#include "tests/tracer/shading/test_directions.h"

namespace becalm::tracer {
namespace {

struct NamedRay {
  std::string name;
  TestRay ray;
};

/// From `from` to `to` in the medium's own box.
TestRay ray_between(const M44d& place, const V3d& from, const V3d& to, bool ends_there) {
  const V3d origin = transform_point(from, place);
  const V3d way = transform_point(to, place) - origin;
  return {V3f(origin), V3f(way.normalized()), ends_there ? static_cast<float>(way.length()) : 50.0f};
}

std::vector<NamedRay> test_rays(const M44d& place) {
  std::vector<NamedRay> rays = {
      {"along x", ray_between(place, {-2, 0.1, 0.2}, {2, 0.1, 0.2}, false)},
      {"along y", ray_between(place, {0.3, 2, -0.4}, {0.3, -2, -0.4}, false)},
      {"along z", ray_between(place, {-0.3, 0.3, -2}, {-0.3, 0.3, 2}, false)},
      {"along the diagonal", ray_between(place, {-1.5, -1.5, -1.5}, {1, 1, 1}, false)},
      {"grazing a side", ray_between(place, {-2, 0.999, 0.0}, {2, 0.97, 0.1}, false)},
      {"starts inside", ray_between(place, {0.1, 0.05, 0.3}, {-1, 0.2, -2}, false)},
      {"ends inside", ray_between(place, {2, -1.5, 1}, {-0.3, 0.1, 0.2}, true)},
      {"starts and ends inside", ray_between(place, {-0.6, -0.2, -0.5}, {0.5, 0.4, 0.6}, true)},
      {"misses", ray_between(place, {-2, 1.2, 0}, {2, 1.2, 0.5}, false)},
      {"behind", ray_between(place, {2, 0, 0}, {3, 0, 0}, false)},
  };
  TestRandom random(40);
  for (int i = 0; i < 30; ++i) {
    const auto point = [&](double size) {
      const double x = size * (2.0 * random.next() - 1.0), y = size * (2.0 * random.next() - 1.0);
      return V3d(x, y, size * (2.0 * random.next() - 1.0));
    };
    const V3d from = point(1.5);
    rays.push_back({fmt::format("random {}", i), ray_between(place, from, point(1.0), i % 2 == 0)});
  }
  return rays;
}

TEST(GridMedium, TransmittanceAgreesWithQuadrature) {
  const float extinctions[] = {0.3f, 2.0f, 12.0f};
  const M44d places[] = {M44d(), oblique_place()};
  const double level = sidak_level(0.01, 3 * 2 * 40);
  int attenuated = 0;
  for (const M44d& at : places) {
    for (const float extinction : extinctions) {
      const GridMedium medium = place(lumpy_grid(), at, extinction);
      TestRandom random(41);
      for (const auto& [name, ray] : test_rays(at)) {
        const double truth = std::exp(-optical_depths(medium, ray, {ray.t_max})[0]);
        MeanTest mean;
        for (int i = 0; i < 4000; ++i) {
          MediumRandom tracking = medium_random(random);
          const float estimate = transmittance(medium, ray.origin, ray.dir, ray.t_max, tracking);
          ASSERT_TRUE(estimate >= 0.0f && estimate <= 1.0f);
          mean.add(estimate);
        }
        attenuated += truth < 0.9 ? 1 : 0;
        // Transmittances so small that no sample has passed cannot be told from 0.
        if (mean.mean() == 0.0 && truth < 1e-3) continue;
        EXPECT_GT(mean.p_value(truth), level)
            << name << " extinction " << extinction << ": " << mean.mean() << " for " << truth << ", seed 41";
      }
    }
  }
  EXPECT_GT(attenuated, 60);
}

TEST(GridMedium, DistancesFollowTheirDensity) {
  constexpr int bins = 64;
  constexpr int samples = 20000;
  const M44d at = oblique_place();
  const GridMedium medium = place(lumpy_grid(), at, 3.0f);
  const std::vector<NamedRay> rays = test_rays(at);
  const double level = sidak_level(0.01, static_cast<int>(rays.size()));
  for (const auto& [name, ray] : rays) {
    std::vector<double> ends(bins);
    for (int b = 0; b < bins; ++b) ends[b] = double{ray.t_max} * (b + 1) / bins;
    const std::vector<double> depths = optical_depths(medium, ray, ends);
    std::vector<double> expected, observed(bins + 1, 0.0);
    double before = 1.0;
    for (const double depth : depths) {
      expected.push_back(samples * (before - std::exp(-depth)));
      before = std::exp(-depth);
    }
    expected.push_back(samples * before);
    EXPECT_NEAR(std::accumulate(expected.begin(), expected.end(), 0.0), samples, 1e-6 * samples);
    TestRandom random(42);
    for (int i = 0; i < samples; ++i) {
      MediumRandom tracking = medium_random(random);
      const MediumSample sample = sample_distance(medium, ray.origin, ray.dir, ray.t_max, tracking);
      ASSERT_EQ(sample.weight, sample.scattered ? medium.albedo : V3f(1.0f));
      observed[sample.scattered ? std::min(bins - 1, static_cast<int>(sample.t / ray.t_max * bins)) : bins] +=
          1;
    }
    EXPECT_GT(chi_square(observed, expected).p_value, level) << name << " seed 42";
  }
}

TEST(GridMedium, ScaledWorldGivesTheSamePicture) {
  for (const double scale : {1e-4, 1.0, 1e6}) {
    M44d at;
    at.translate(Imath::V3d(3.0 * scale, 0.0, 0.0));
    at.scale(Imath::V3d(scale));
    const GridMedium medium = place(lumpy_grid(), at, static_cast<float>(4.0 / scale));
    const TestRay ray = ray_between(at, {-1.5, 0.1, -0.8}, {0.7, -0.1, 0.9}, true);
    const GridMedium unit = place(lumpy_grid(), M44d(), 4.0f);
    const TestRay unit_ray = ray_between(M44d(), {-1.5, 0.1, -0.8}, {0.7, -0.1, 0.9}, true);
    const double truth = std::exp(-optical_depths(unit, unit_ray, {unit_ray.t_max})[0]);
    ASSERT_LT(truth, 0.8);
    MeanTest mean;
    TestRandom random(43);
    for (int i = 0; i < 10000; ++i) {
      MediumRandom tracking = medium_random(random);
      mean.add(transmittance(medium, ray.origin, ray.dir, ray.t_max, tracking));
    }
    EXPECT_GT(mean.p_value(truth), 1e-3) << "scale " << scale;
  }
}

TEST(GridMedium, ExtremesGiveFiniteResults) {
  TestRandom random(44);
  for (const float extinction : {0.0f, 1e-30f, 1.0f, 1e30f}) {
    const GridMedium medium = place(lumpy_grid(), oblique_place(), extinction);
    for (const auto& [name, ray] : test_rays(oblique_place())) {
      for (const float t_max : {0.0f, 1e-30f, ray.t_max, 1e30f, kInfinity}) {
        for (const float offset : {0.0f, 1e6f, 1e30f, kInfinity}) {
          MediumRandom tracking = medium_random(random);
          const V3f origin = ray.origin + V3f(offset, 0.0f, 0.0f);
          const float passed = transmittance(medium, origin, ray.dir, t_max, tracking);
          ASSERT_TRUE(passed >= 0.0f && passed <= 1.0f) << name << " " << extinction << " " << t_max;
          const MediumSample sample = sample_distance(medium, origin, ray.dir, t_max, tracking);
          ASSERT_TRUE(sample.scattered ? sample.t >= 0.0f && sample.t <= t_max : sample.t == t_max);
          if (extinction <= 1e-30f || t_max <= 1e-30f) {
            ASSERT_EQ(passed, 1.0f);
            ASSERT_FALSE(sample.scattered);
          }
        }
      }
    }
  }
}

TEST(GridMedium, DensestMediumIsOpaqueWhereItBegins) {
  const M44d at = oblique_place();
  const GridMedium medium = place(lumpy_grid(), at, 1e30f);
  const TestRay ray = ray_between(at, {-0.79, 0.34, -2.0}, {-0.79, 0.34, 2.0}, false);
  std::vector<double> distances;
  for (int i = 1; i <= 4000; ++i) distances.push_back(ray.t_max * i / 4000.0);
  const std::vector<double> depths = optical_depths(medium, ray, distances);
  // Between where there is any density and where a mean free path of 1/256 voxel has been passed 20 times.
  const auto first_beyond = [&](double depth) {
    const auto found = std::upper_bound(depths.begin(), depths.end(), depth);
    return found == depths.end() ? INFINITY : distances[found - depths.begin()];
  };
  const float voxel = 1.0f / transform_vector(ray.dir, medium.world_to_voxels).length();
  const double step = ray.t_max / 4000.0;
  const double begins = first_beyond(0.0) - step;
  const double opaque = first_beyond(20.0 * voxel / kLargestDepthPerVoxel * medium.extinction) + step;
  ASSERT_LT(opaque, ray.t_max);
  TestRandom random(45);
  for (int i = 0; i < 200; ++i) {
    MediumRandom tracking = medium_random(random);
    const MediumSample sample = sample_distance(medium, ray.origin, ray.dir, ray.t_max, tracking);
    ASSERT_TRUE(sample.scattered);
    ASSERT_GE(sample.t, begins);
    ASSERT_LE(sample.t, opaque);
    ASSERT_EQ(transmittance(medium, ray.origin, ray.dir, ray.t_max, tracking), 0.0f);
  }
}

TEST(GridMedium, WithoutDensityNothingHappens) {
  const GridMedium empty = place(DensityGrid(V3i(20), std::vector<float>(8000, 0.0f)), M44d(), 1.0f);
  TestRandom random(46);
  for (const GridMedium& medium : {empty, GridMedium{}}) {
    MediumRandom tracking = medium_random(random);
    EXPECT_EQ(transmittance(medium, V3f(0.0f), V3f(0, 0, 1), kInfinity, tracking), 1.0f);
    EXPECT_FALSE(sample_distance(medium, V3f(0.0f), V3f(0, 0, 1), kInfinity, tracking).scattered);
  }
}

}  // namespace
}  // namespace becalm::tracer
