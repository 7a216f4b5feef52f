#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/filter/glsl.h"

namespace becalm::glsl {
namespace {

struct Minimum {
  bool found;
  float x;
  float y;
};

/// The fit to the values of `f` on the 3x3 grid.
template <class F>
Minimum fit(F f) {
  Minimum m{};
  m.found = quadric_minimum(f(-1, -1), f(0, -1), f(1, -1), f(-1, 0), f(0, 0), f(1, 0), f(-1, 1), f(0, 1),
                            f(1, 1), 1e-5f * f(0, 0), m.x, m.y);
  return m;
}

TEST(Quadric, FindsTheMinimumOfEveryQuadric) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  int tried = 0;
  while (tried < 200) {
    const float x0 = 0.7f * uniform(random), y0 = 0.7f * uniform(random);
    const float a = 0.1f + std::abs(uniform(random)), b = 0.1f + std::abs(uniform(random));
    const float c = 0.5f * uniform(random) * std::min(a, b);  // keeps it positive definite
    const auto m = fit([&](float x, float y) {
      return 3.0f + a * (x - x0) * (x - x0) + b * (y - y0) * (y - y0) + 2.0f * c * (x - x0) * (y - y0);
    });
    ++tried;
    if (x0 * x0 + y0 * y0 > 0.98f) continue;
    ASSERT_TRUE(m.found) << "a=" << a << " b=" << b << " c=" << c;
    // A hundredth of the larger curvature is added in both directions, which shrinks the offset along the
    // weaker one.
    const float shrink = 0.03f * std::max(a, b) / (std::min(a, b) - std::abs(c));
    EXPECT_NEAR(m.x, x0, 1e-3f + shrink);
    EXPECT_NEAR(m.y, y0, 1e-3f + shrink);
  }
}

TEST(Quadric, DoesNotDependOnTheScaleOfTheCosts) {
  const auto cost = [](float x, float y) {
    return (x - 0.25f) * (x - 0.25f) + 2.0f * (y + 0.4f) * (y + 0.4f);
  };
  for (const float scale : {1e-12f, 1.0f, 1e12f}) {
    const auto m = fit([&](float x, float y) { return scale * cost(x, y); });
    ASSERT_TRUE(m.found) << scale;
    EXPECT_NEAR(m.x, 0.25f, 0.006f) << scale;
    EXPECT_NEAR(m.y, -0.4f, 0.006f) << scale;
  }
}

TEST(Quadric, TakesTheNearestPointOfAValley) {
  const auto m = fit([](float x, float y) { return 1.0f + (x + y - 0.6f) * (x + y - 0.6f); });
  ASSERT_TRUE(m.found);
  EXPECT_NEAR(m.x, 0.3f, 0.01f);
  EXPECT_NEAR(m.y, 0.3f, 0.01f);
}

TEST(Quadric, APerfectMatchHasNoSubpixelPart) {
  EXPECT_EQ(subpixel_limit(0.0f, 1.0f, 3.0f, false), 0.0f);
  EXPECT_FLOAT_EQ(subpixel_limit(0.5f, 1.0f, 1.0f, false), 0.5f);
  EXPECT_FLOAT_EQ(subpixel_limit(0.25f, 1.0f, 1.0f, true), 0.5f);
  EXPECT_EQ(subpixel_limit(0.0f, 0.0f, 0.0f, false), 0.0f);
}

TEST(Quadric, HasNoMinimumOnPlanesSaddlesAndFarAway) {
  const auto no_minimum = [](auto f) {
    const Minimum m = fit(f);
    return !m.found && m.x == 0.0f && m.y == 0.0f;
  };
  EXPECT_TRUE(no_minimum([](float, float) { return 1.0f; }));
  EXPECT_TRUE(no_minimum([](float x, float y) { return x - 2.0f * y; }));
  EXPECT_TRUE(no_minimum([](float x, float y) { return x * x - y * y; }));
  EXPECT_TRUE(no_minimum([](float x, float y) { return (x - 3.0f) * (x - 3.0f) + y * y; }));
  EXPECT_TRUE(no_minimum([](float x, float y) { return x == 0.0f && y == 0.0f ? std::nanf("") : 1.0f; }));
}

TEST(Distance, FollowsThePapersEquations) {
  const auto distance = [](int kind, float d) {
    return distance_unit(kind) * (distance_floor(kind) + distance_excess(kind, channel_difference(kind, d)));
  };
  const float d = 0.3f;
  EXPECT_FLOAT_EQ(distance(kDistanceL2, -d), 0.09f);
  EXPECT_FLOAT_EQ(distance(kDistanceL1, -d), 0.3f);
  EXPECT_FLOAT_EQ(distance(kDistanceLogL1, -d), std::log(2.3f));
  EXPECT_FLOAT_EQ(distance(kDistanceLogL1Centered, -d), std::log(2.3f));
  EXPECT_FLOAT_EQ(center_weight(kDistanceLogL1Centered, 2, -1), 2.0f - std::exp(-0.1f));
  EXPECT_FLOAT_EQ(center_weight(kDistanceLogL1Centered, 0, 0), 1.0f);
  EXPECT_FLOAT_EQ(center_weight(kDistanceLogL1, 2, 2), 1.0f);
  for (int kind = 0; kind < 4; ++kind) EXPECT_EQ(distance_excess(kind, 0.0f), 0.0f) << kind;
}

TEST(CatmullRom, ReproducesCubicsAndKeepsTaps) {
  for (float t = 0.0f; t < 1.0f; t += 0.0625f) {
    float w0, w1, w2, w3;
    catmull_rom(t, w0, w1, w2, w3);
    EXPECT_NEAR(w0 + w1 + w2 + w3, 1.0f, 1e-6f);
    EXPECT_NEAR(-w0 + w2 + 2.0f * w3, t, 1e-6f);
    EXPECT_NEAR(w0 + w2 + 4.0f * w3, t * t, 1e-6f);
  }
  float w0, w1, w2, w3;
  catmull_rom(0.0f, w0, w1, w2, w3);
  EXPECT_EQ(w0, 0.0f);
  EXPECT_EQ(w1, 1.0f);
  EXPECT_EQ(w2, 0.0f);
  EXPECT_EQ(w3, 0.0f);
}

TEST(SharpShare, EndsWhereTheRangeDoes) {
  EXPECT_EQ(sharp_share(0.7f, 0.5f, 0.0f, 1.0f), 1.0f);
  EXPECT_FLOAT_EQ(sharp_share(2.0f, 0.5f, 0.0f, 1.0f), 1.0f / 3.0f);
  EXPECT_FLOAT_EQ(sharp_share(-1.0f, 0.5f, 0.0f, 1.0f), 1.0f / 3.0f);
  EXPECT_EQ(sharp_share(1.0f, 0.0f, 0.0f, 0.0f), 0.0f);
  EXPECT_EQ(sharp_share(-1.0f, 0.0f, 0.0f, 0.0f), 0.0f);
  EXPECT_EQ(sharp_share(1.000001f, 1.0f, 1.0f, 1.0f), 1.0f) << "rounding limits nothing";
}

TEST(Gain, AveragesEvenlyWithoutBias) {
  // Eq. 6: with equal variances the weights give the running mean.
  float n = 1.0f;
  for (int frame = 2; frame <= static_cast<int>(kMostFrames); ++frame) {
    const float alpha = gain(0.5f, 0.5f / n, 0.0f);
    EXPECT_NEAR(alpha, 1.0f / frame, 1e-6f);
    n = blended_count(n, alpha);
    EXPECT_NEAR(n, frame, 1e-3f * frame);
  }
  EXPECT_EQ(blended_count(kMostFrames, 0.001f), kMostFrames);
}

TEST(Gain, KeepsToItsLimits) {
  EXPECT_EQ(gain(0.0f, 0.0f, 0.0f), 1.0f);
  EXPECT_EQ(gain(0.0f, 1.0f, 0.0f), 1.0f);
  EXPECT_EQ(gain(1.0f, 0.0f, 0.0f), 0.0f);
  EXPECT_GT(gain(1.0f, 0.1f, 1e6f), 0.999f);
  EXPECT_EQ(blended_count(0.0f, 0.3f), 1.0f);
  EXPECT_EQ(blended_count(17.0f, 1.0f), 1.0f);
  EXPECT_EQ(excess_over_noise(1.0f, 2.0f, 10.0f, 0.0f), 0.0f);
  EXPECT_FLOAT_EQ(excess_over_noise(3.0f, 1.0f, 8.0f, 2.0f), 1.0f);
}

TEST(Bias, OfSmoothedFramesGrowsWithTheDifference) {
  constexpr float kNoise = 2.0f;
  EXPECT_EQ(smoothed_bias(0.0f, 0.0f), 0.0f);
  EXPECT_EQ(smoothed_bias(0.0f, kNoise), 0.0f);
  EXPECT_EQ(smoothed_bias(3.0f, 0.0f), 3.0f);
  EXPECT_FLOAT_EQ(smoothed_bias(kNoise, kNoise), 0.125f * kNoise);
  EXPECT_NEAR(smoothed_bias(1000.0f * kNoise, kNoise), 997.0f * kNoise, 0.1f * kNoise);
  for (float square = 1e-9f; square < 1e18f; square *= 10.0f) {
    EXPECT_GT(smoothed_bias(square, kNoise), 0.0f) << square;
    EXPECT_LE(smoothed_bias(square, kNoise), square);
    EXPECT_GT(smoothed_bias(2.0f * square, kNoise), smoothed_bias(square, kNoise));
  }
}

TEST(UnsharedPart, IsLessTheMoreOfTheErrorIsBlur) {
  EXPECT_EQ(unshared_part(0.0f, 1.0f), 1.0f);
  EXPECT_FLOAT_EQ(unshared_part(1.0f / kBlurInError, 1.0f), 0.5f);
  EXPECT_EQ(unshared_part(1.0f, 0.0f), 0.0f) << "a frame without noise differs from the next by no noise";
  EXPECT_EQ(unshared_part(0.0f, 0.0f), 0.0f);
  EXPECT_FLOAT_EQ(unshared_part(1e18f, 1e18f), 1.0f / (1.0f + kBlurInError)) << "the largest variances";
  EXPECT_GT(unshared_part(1e-30f, 1e-30f), 0.0f);
}

TEST(Bias, OfNoisyFramesIsWhatNoiseLeaves) {
  EXPECT_EQ(patch_bias(0.1f, 1.5f, 1.0f, 48.0f, false), 0.0f);
  EXPECT_FLOAT_EQ(patch_bias(0.1f, 1.5f, 1.0f, 48.0f, true), smoothed_bias(1.5f, 1.0f));
  EXPECT_GT(patch_bias(0.1f, 2.0f, 1.0f, 48.0f, false), 0.0f);
  EXPECT_GT(patch_bias(0.2f, 1.0f, 1.0f, 48.0f, false), 0.0f);
}

TEST(Compress, LiesInUnitRangeWhateverTheRadiance) {
  EXPECT_EQ(compress(exposed(-1.0f, 1.0f)), 0.0f);
  EXPECT_EQ(compress(exposed(0.0f, 1e15f)), 0.0f);
  EXPECT_FLOAT_EQ(compress(exposed(2.0f, 0.5f)), 0.5f);
  EXPECT_FLOAT_EQ(compress(exposed(std::numeric_limits<float>::max(), 1e15f)), 16.0f / 17.0f);
}

TEST(MosaicFunctions, StabilizeTheVariance) {
  for (const auto& [a, b] : {std::pair{2e-4f, 1e-6f}, std::pair{0.0f, 1e-4f}, std::pair{3e-3f, 1e-4f}}) {
    for (const float signal : {0.02f, 0.2f, 0.9f}) {
      const float deviation = std::sqrt(glsl::noise_variance(a, b, signal));
      const float step = 0.1f * deviation;
      const float slope =
          (glsl::stabilized(a, b, signal + step) - glsl::stabilized(a, b, signal - step)) / (2 * step);
      EXPECT_NEAR(slope * deviation, 1.0f, 0.06f) << a << ' ' << signal;
    }
    EXPECT_LT(glsl::stabilized(a, b, -0.01f), 0.0f) << "continues below black";
  }
}

TEST(MosaicFunctions, ReadOutsideAtASampleOfTheSameColour) {
  for (const int period : {2, 6}) {
    for (int at = -13; at < 40; ++at) {
      const int inside = glsl::mirrored(at, 25, period);
      EXPECT_TRUE(inside >= 0 && inside < 25) << at;
      EXPECT_EQ((inside - at) % period, 0) << at;
      if (at >= 0 && at < 25) {
        EXPECT_EQ(inside, at);
      }
    }
  }
}

TEST(MosaicFunctions, WeighByTheExpectedError) {
  const float count = 49.0f;
  EXPECT_FLOAT_EQ(glsl::frame_weight(0.0f, count, count, 1.0f, 1.0f), 1.0f) << "noise alone";
  EXPECT_FLOAT_EQ(glsl::frame_weight(0.0f, count, count, 1.0f, 0.5f), 2.0f) << "a frame of half the variance";
  EXPECT_LT(glsl::frame_weight(0.0f, 2.0f * count, count, 1.0f, 1.0f), 0.5f) << "differences beyond noise";
  EXPECT_EQ(glsl::frame_weight(0.0f, 6.0f * count, count, 1.0f, 1.0f), 0.0f) << "another thing";
  EXPECT_EQ(glsl::frame_weight(2.2f * count, 4.9f * count, count, 1.0f, 1.0f), 0.0f)
      << "darker by more than two deviations";
}

}  // namespace
}  // namespace becalm::glsl
