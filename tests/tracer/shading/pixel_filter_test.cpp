// Pixel filters: samples follow the filter, keep stratification, and stay inside the radius.
#include "tracer/sampling/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

const std::vector<PixelFilter> kFilters = {{FilterShape::blackman_harris, 1.5f},
                                           {FilterShape::blackman_harris, 3.0f},
                                           {FilterShape::box, 0.5f},
                                           {FilterShape::box, 2.0f},
                                           {FilterShape::tent, 1.0f},
                                           {FilterShape::tent, 1.5f}};

/// Density on [-1,1] along one axis.
double density(FilterShape type, double t) {
  if (type == FilterShape::box) return 0.5;
  if (type == FilterShape::tent) return 1.0 - std::abs(t);
  return blackman_harris_window(std::abs(t)) / (2.0 * kBlackmanHarrisMean);
}

TEST(PixelFilter, samples_match_their_density) {
  std::uint32_t seed = 500;
  const double level = sidak_level(0.01, static_cast<int>(kFilters.size()));
  for (const PixelFilter& filter : kFilters) {
    Chart chart;
    const double r = filter.radius_px;
    chart.domain = {-r, r, -r, r};
    chart.draw = [&](TestRandom& random) { return std::optional(V2d(sample(filter, random.next_2d()))); };
    chart.density = [&](const V2d& p) {
      return density(filter.type, p.x / r) * density(filter.type, p.y / r) / (r * r);
    };
    const SamplerTest test = test_sampler(chart, ++seed, 200000);
    EXPECT_GT(test.result.p_value, level)
        << "filter " << static_cast<int>(filter.type) << " radius " << r << " " << test.replay;
    EXPECT_NEAR(test.integral, 1.0, 1e-4);
  }
}

TEST(PixelFilter, stays_inside_and_is_monotone) {
  for (const PixelFilter& filter : kFilters) {
    float last = -filter.radius_px * 1.000001f;
    for (int i = 0; i <= 4096; ++i) {
      const float u = std::min(static_cast<float>(i) / 4096.0f, 0x1.fffffep-1f);
      const V2f offset = sample(filter, V2f(u, 1.0f - u));
      EXPECT_LE(std::abs(offset.x), filter.radius_px * 1.000001f);
      EXPECT_GE(offset.x, last) << "u " << u;
      EXPECT_NEAR(offset.x, offset.y == 0.0f ? 0.0f : -sample(filter, V2f(1.0f - u)).x, 2e-3f);
      last = offset.x;
    }
    EXPECT_NEAR(sample(filter, V2f(0.5f)).length(), 0.0f, 1e-6f);
  }
}

TEST(PixelFilter, blackman_harris_is_the_published_window) {
  EXPECT_NEAR(blackman_harris_window(0.0), 1.0, 1e-12);
  EXPECT_NEAR(blackman_harris_window(0.5), 0.35875 - 0.14128, 1e-12);
  EXPECT_NEAR(blackman_harris_window(1.0), 6e-5, 1e-12);
}

}  // namespace
}  // namespace becalm::tracer
