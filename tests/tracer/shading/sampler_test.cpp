// The sampler: its points are scrambled Sobol points, stratified, repeatable and independent of each other.
#include "tracer/sampling/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

/// The point of the `call`-th next_2d() of a sample.
V2f point_2d(std::uint32_t seed, int frame, int x, int y, std::uint32_t sample, int call) {
  Sampler sampler(seed, frame, x, y, sample);
  V2f point;
  for (int i = 0; i <= call; ++i) point = sampler.next_2d();
  return point;
}

std::uint32_t second_dimension(std::uint32_t index) {
  std::uint32_t direction = 0x80000000u;
  std::uint32_t point = 0;
  for (int bit = 0; bit < 32; ++bit) {
    if (index >> bit & 1u) point ^= direction;
    direction ^= direction >> 1;
  }
  return point;
}

TEST(Sobol, second_dimension_follows_its_direction_numbers) {
  for (int bit = 0; bit < 32; ++bit) {
    EXPECT_EQ(reverse_bits(sobol_1_reversed(1u << bit)), second_dimension(1u << bit)) << "bit " << bit;
  }
  for (const std::uint32_t index : {0u, 3u, 77u, 65535u, 0x12345678u, 0xffffffffu}) {
    EXPECT_EQ(reverse_bits(sobol_1_reversed(index)), second_dimension(index)) << index;
  }
}

TEST(Sobol, reverse_bits_reverses) {
  EXPECT_EQ(reverse_bits(1u), 0x80000000u);
  EXPECT_EQ(reverse_bits(0x0000000fu), 0xf0000000u);
  EXPECT_EQ(reverse_bits(reverse_bits(0x12345678u)), 0x12345678u);
}

/// Owen scrambling permutes the halves of every interval: numbers that share their highest k bits still do,
/// and go apart at bit k + 1.
TEST(Sobol, owen_scramble_is_nested) {
  TestRandom random(5);
  for (int i = 0; i < 2000; ++i) {
    const auto a = static_cast<std::uint32_t>(random.next() * 4294967296.0);
    const int shared = static_cast<int>(random.next() * 31.0f);
    const std::uint32_t b =
        a ^ (0x80000000u >> shared) ^
        (static_cast<std::uint32_t>(random.next() * 4294967296.0) & (0x7fffffffu >> shared));
    const auto seed = static_cast<std::uint32_t>(random.next() * 4294967296.0);
    const std::uint32_t difference = owen_scramble(a, seed) ^ owen_scramble(b, seed);
    ASSERT_EQ(__builtin_clz(difference), shared) << "a " << a << " b " << b << " seed " << seed;
  }
}

/// Every elementary box of area 1/n holds one of n = 2^k points.
void expect_net(const std::vector<V2f>& points, const std::string& replay) {
  const int n = static_cast<int>(points.size());
  for (int columns = 1; columns <= n; columns *= 2) {
    const int rows = n / columns;
    std::set<std::pair<int, int>> boxes;
    for (const V2f& p : points) {
      boxes.emplace(static_cast<int>(p.x * static_cast<float>(columns)),
                    static_cast<int>(p.y * static_cast<float>(rows)));
    }
    EXPECT_EQ(boxes.size(), points.size()) << replay << ": " << columns << " x " << rows << " boxes";
  }
}

TEST(Sampler, points_of_a_pixel_are_nets) {
  for (const std::uint32_t n : {1u, 2u, 16u, 64u, 256u}) {
    for (int pixel = 0; pixel < 8; ++pixel) {
      for (int call = 0; call < 4; ++call) {
        // The first n, and the block of n that follows: halves of a pixel are nets too.
        for (const std::uint32_t first : {0u, n}) {
          std::vector<V2f> points;
          for (std::uint32_t s = first; s < first + n; ++s)
            points.push_back(point_2d(9, 3, pixel, 2 * pixel, s, call));
          expect_net(points, "seed 9 frame 3 pixel " + std::to_string(pixel) + " call " +
                                 std::to_string(call) + " samples " + std::to_string(first) + "+" +
                                 std::to_string(n));
        }
      }
    }
  }
}

TEST(Sampler, single_numbers_of_a_pixel_are_stratified) {
  for (int call = 0; call < 6; ++call) {
    std::set<int> intervals;
    for (std::uint32_t s = 0; s < 64; ++s) {
      Sampler sampler(1, 2, 3, 4, s);
      float value = 0.0f;
      for (int i = 0; i <= call; ++i) value = sampler.next_1d();
      ASSERT_GE(value, 0.0f);
      ASSERT_LT(value, 1.0f);
      intervals.insert(static_cast<int>(value * 64.0f));
    }
    EXPECT_EQ(intervals.size(), 64u) << "call " << call;
  }
}

TEST(Sampler, depends_on_nothing_else) {
  Sampler first(7, 12, 640, 359, 5);
  std::vector<float> values(10);
  for (int i = 0; i < 10; ++i) values[i] = i % 3 == 0 ? first.next_1d() : first.next_2d().y;
  Sampler other(8, 12, 640, 359, 5);
  other.next_2d();
  Sampler again(7, 12, 640, 359, 5);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(values[i], i % 3 == 0 ? again.next_1d() : again.next_2d().y);
}

/// Drawn together or one by one, the numbers are the same.
TEST(Sampler, several_calls_at_once_draw_the_same) {
  for (const std::uint32_t sample : {0u, 1u, 77u, 0xffffffffu}) {
    Sampler together(5, 3, 17, 4, sample), single(5, 3, 17, 4, sample);
    for (int event = 0; event < 3; ++event) {
      const auto [a, b, c, d, e] = together.next<float, V2f, V2f, float, float>();
      EXPECT_EQ(a, single.next_1d());
      EXPECT_EQ(b, single.next_2d());
      EXPECT_EQ(c, single.next_2d());
      EXPECT_EQ(d, single.next_1d());
      EXPECT_EQ(e, single.next_1d());
      const auto [f] = together.next<V2f>();
      EXPECT_EQ(f, single.next_2d());
    }
  }
}

/// The values themselves: a change here changes every image, and makes half-rendered shots impossible to
/// resume.
TEST(Sampler, values_are_fixed) {
  const V2f p = point_2d(0, 1, 0, 0, 0, 0);
  const V2f q = point_2d(42, 24, 1919, 1079, 7, 3);
  EXPECT_EQ(p * 0x1p24f, V2f(9474549.0f, 13663588.0f));
  EXPECT_EQ(q * 0x1p24f, V2f(10744018.0f, 12437673.0f));
}

/// Uniform over pixels, for a fixed sample: what a pixel's first points are must not be preferred anywhere.
TEST(Sampler, uniform_over_pixels_seeds_and_frames) {
  const double level = sidak_level(0.01, 9);
  for (const std::uint32_t sample : {0u, 1u, 1000003u}) {
    for (int what = 0; what < 3; ++what) {
      std::vector<double> observed(256, 0.0);
      constexpr int count = 65536;
      for (int i = 0; i < count; ++i) {
        const V2f p = what == 0   ? point_2d(1, 1, i % 256, i / 256, sample, 1)
                      : what == 1 ? point_2d(static_cast<std::uint32_t>(i), 1, 10, 10, sample, 1)
                                  : point_2d(1, i, 10, 10, sample, 1);
        observed[static_cast<int>(p.y * 16.0f) * 16 + static_cast<int>(p.x * 16.0f)] += 1.0;
      }
      const ChiSquare result = chi_square(observed, std::vector<double>(256, count / 256.0));
      EXPECT_GT(result.p_value, level)
          << "sample " << sample << " over " << what << " chi^2 " << result.statistic;
    }
  }
}

/// Pearson's correlation of pairs of numbers, as a z-score: normal for independent ones.
double correlation_z(int count, const std::function<std::pair<double, double>(int)>& pair) {
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const auto [a, b] = pair(i);
    sum += (a - 0.5) * (b - 0.5);
  }
  return sum * 12.0 / std::sqrt(static_cast<double>(count));
}

TEST(Sampler, pixels_frames_seeds_samples_and_dimensions_are_uncorrelated) {
  constexpr int count = 65536;
  // |z| < 4.2: 3e-5 each, below 1e-3 for the suite of 24.
  for (const std::uint32_t sample : {0u, 3u}) {
    const auto value = [&](std::uint32_t seed, int frame, int x, int y, std::uint32_t s, int call) {
      return static_cast<double>(point_2d(seed, frame, x, y, s, call).x);
    };
    const auto check = [&](const char* what, const std::function<double(int, int)>& other) {
      const double z = correlation_z(count, [&](int i) {
        const int x = i % 256;
        const int y = i / 256;
        return std::pair(value(1, 1, x, y, sample, 0), other(x, y));
      });
      EXPECT_LT(std::abs(z), 4.2) << what << " sample " << sample;
    };
    check("next frame", [&](int x, int y) { return value(1, 2, x, y, sample, 0); });
    check("frame 257", [&](int x, int y) { return value(1, 257, x, y, sample, 0); });
    check("next seed", [&](int x, int y) { return value(2, 1, x, y, sample, 0); });
    check("seed and frame swapped", [&](int x, int y) { return value(2, 0, x, y, sample, 0); });
    check("right pixel", [&](int x, int y) { return value(1, 1, x + 1, y, sample, 0); });
    check("lower pixel", [&](int x, int y) { return value(1, 1, x, y + 1, sample, 0); });
    check("transposed pixel", [&](int x, int y) { return x == y ? 0.5 : value(1, 1, y, x, sample, 0); });
    check("next 2d call", [&](int x, int y) { return value(1, 1, x, y, sample, 1); });
    check("fourth 2d call", [&](int x, int y) { return value(1, 1, x, y, sample, 4); });
    check("own y", [&](int x, int y) { return static_cast<double>(point_2d(1, 1, x, y, sample, 0).y); });
  }
}

/// Within one pixel, the pairs (first call, second call) over its samples form no pattern: each call is
/// shuffled.
TEST(Sampler, calls_of_one_pixel_are_shuffled_against_each_other) {
  std::vector<double> observed(64, 0.0);
  constexpr int pixels = 400;
  for (int pixel = 0; pixel < pixels; ++pixel) {
    for (std::uint32_t s = 0; s < 64; ++s) {
      Sampler sampler(3, 1, pixel, 0, s);
      const float a = sampler.next_2d().x;
      const float b = sampler.next_2d().x;
      observed[static_cast<int>(b * 8.0f) * 8 + static_cast<int>(a * 8.0f)] += 1.0;
    }
  }
  const ChiSquare result = chi_square(observed, std::vector<double>(64, pixels));
  EXPECT_GT(result.p_value, 0.001) << "chi^2 " << result.statistic;
}

/// Integrates a smooth function far better than independent points: the variance of 256-point estimates.
TEST(Sampler, converges_faster_than_random) {
  const auto deviation = [](const std::function<V2f(int, std::uint32_t)>& point) {
    double squares = 0.0;
    constexpr int trials = 200;
    for (int trial = 0; trial < trials; ++trial) {
      double sum = 0.0;
      for (std::uint32_t s = 0; s < 256; ++s) {
        const V2f p = point(trial, s);
        sum += static_cast<double>(p.x) * p.y;
      }
      squares += (sum / 256.0 - 0.25) * (sum / 256.0 - 0.25);
    }
    return std::sqrt(squares / trials);
  };
  TestRandom random(6);
  const double independent = deviation([&](int, std::uint32_t) { return random.next_2d(); });
  const double sobol = deviation([&](int trial, std::uint32_t s) { return point_2d(1, 1, trial, 0, s, 0); });
  EXPECT_LT(sobol, independent / 30.0) << sobol << " against " << independent;
}

TEST(Sampler, extreme_coordinates_give_numbers_in_range) {
  for (const std::uint32_t seed : {0u, 0xffffffffu}) {
    for (const int frame : {-2147483647, -1, 0, 2147483647}) {
      for (const std::uint32_t sample : {0u, 65535u, 0xffffffffu}) {
        Sampler sampler(seed, frame, -1, 2147483647, sample);
        for (int i = 0; i < 1000; ++i) {
          const V2f p = sampler.next_2d();
          ASSERT_TRUE(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f) << p;
        }
      }
    }
  }
}

}  // namespace
}  // namespace becalm::tracer
