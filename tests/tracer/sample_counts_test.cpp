// How adaptive sampling shares out samples, and what the tracer makes of the counts.
#include "tracer/sample_counts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "frame/error.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

double mean_of(const Image& counts) {
  return std::accumulate(counts.data().begin(), counts.data().end(), 0.0) /
         static_cast<double>(counts.pixel_count());
}

/// Errors of `left` in the left half and `right` in the right one.
Pilot two_halves(float left, float right, int width = 64, int height = 32) {
  Pilot pilot{Image(width, height, 1), 0.5};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) pilot.error.at(x, y, 0) = x < width / 2 ? left : right;
  }
  return pilot;
}

TEST(SampleCounts, KeepTheMeanAndFollowTheRootOfTheError) {
  const Image counts = counts_of_mean(two_halves(0.01f, 0.16f), 256, 128, 10.0, {.least = 1, .most = 100});
  EXPECT_NEAR(mean_of(counts), 10.0, 0.2);
  EXPECT_EQ(counts.at(20, 60, 0), 4.0f);
  EXPECT_EQ(counts.at(230, 60, 0), 16.0f);
}

TEST(SampleCounts, ChangeGraduallyBetweenBlocks) {
  const Image counts = counts_of_mean(two_halves(0.0001f, 1.0f), 256, 128, 40.0, {.least = 1, .most = 1000});
  for (int x = 1; x < 256; ++x) {
    EXPECT_LE(std::abs(counts.at(x, 64, 0) - counts.at(x - 1, 64, 0)), 6.0f) << x;
  }
}

TEST(SampleCounts, StayWithinTheLimits) {
  const SampleLimits limits{.least = 2, .most = 12};
  for (const double mean : {0.5, 4.0, 8.0, 100.0}) {
    const Image counts = counts_of_mean(two_halves(1e-12f, 1e12f), 256, 128, mean, limits);
    const auto [low, high] = std::ranges::minmax(counts.data());
    EXPECT_GE(low, 2.0f) << mean;
    EXPECT_LE(high, 12.0f) << mean;
    EXPECT_NEAR(mean_of(counts), std::clamp(mean, 2.0, 12.0), 0.6) << mean;
  }
}

TEST(SampleCounts, AreEvenWhereNoErrorIsKnown) {
  for (const float error :
       {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const Image counts = counts_of_mean(two_halves(error, error), 40, 24, 6.0, {.least = 1, .most = 64});
    for (const float count : counts.data()) ASSERT_EQ(count, 6.0f) << error;
  }
}

TEST(SampleCounts, FitFramesOfAnySize) {
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(17, 1), std::pair(1, 300), std::pair(97, 33)}) {
    const Pilot pilot = two_halves(0.1f, 0.3f, std::max(1, width / 2), std::max(1, height / 2));
    const Image counts = counts_of_mean(pilot, width, height, 5.0, {.least = 1, .most = 40});
    EXPECT_EQ(counts.width(), width);
    EXPECT_EQ(counts.height(), height);
    EXPECT_NEAR(mean_of(counts), 5.0, 0.8);
  }
}

TEST(SampleCounts, KeepTheMeanWhereBlocksAtTheBorderAreSmall) {
  for (const auto& [width, height] : {std::pair(640, 360), std::pair(100, 60), std::pair(48, 34)}) {
    Pilot pilot{Image(width, height, 1, 1e-4f), 0.5};
    for (int x = 0; x < width; ++x) pilot.error.at(x, height - 1, 0) = 10.0f;
    const Image counts = counts_of_mean(pilot, width, height, 16.0, {.least = 4, .most = 64});
    EXPECT_NEAR(mean_of(counts), 16.0, 1.0) << width;
  }
}

TEST(SampleCounts, FollowTheErrorToTheEndOfLargeFrames) {
  constexpr int kSide = 70000;  // its product with the pilot's pixels is beyond 2^31
  Pilot pilot = two_halves(0.01f, 0.16f, kSide / 2, 1);
  const Image wide = counts_of_mean(pilot, kSide, 1, 10.0, {.least = 1, .most = 100});
  pilot.error = Image(1, kSide / 2, 1, 0.01f);
  std::ranges::fill(pilot.error.data().subspan(kSide / 4), 0.16f);
  const Image high = counts_of_mean(pilot, 1, kSide, 10.0, {.least = 1, .most = 100});
  for (const Image* counts : {&wide, &high}) {
    EXPECT_EQ(counts->data().front(), 4.0f);
    EXPECT_EQ(counts->data().back(), 16.0f);
  }
}

TEST(SampleCounts, OfATargetGrowAsItFalls) {
  const Pilot pilot = two_halves(0.04f, 0.04f);
  const SampleLimits limits{.least = 1, .most = 4096};
  double before = 0.0;
  for (const double target : {0.1, 0.07, 0.05, 0.03}) {
    const double mean = mean_of(counts_of_target(pilot, 128, 64, target, limits));
    EXPECT_GT(mean, before) << target;
    before = mean;
  }
  EXPECT_EQ(mean_of(counts_of_target(pilot, 128, 64, 10.0, limits)), 1.0);
  EXPECT_EQ(mean_of(counts_of_target(pilot, 128, 64, 1e-4, limits)), 4096.0);
}

TEST(SampleCounts, OfATargetAreThoseOfTheErrorsDecay) {
  Pilot pilot = two_halves(0.04f, 0.04f);
  pilot.spp = 2.0;
  for (const double target : {0.02, 0.05, 0.1}) {
    // A filtered frame has half the squared error of a pilot of as many samples.
    const double expected = 2.0 * std::pow(0.5 * 0.04 / (target * target), 1.0 / kFilteredErrorDecay);
    const Image counts = counts_of_target(pilot, 128, 64, target, {.least = 1, .most = 65536});
    for (const float count : counts.data()) ASSERT_NEAR(count, expected, 1.0) << target;
  }
}

constexpr const char* kLitFloor = R"({'film': {'width': 24, 'height': 16}, 'integrator': {'max_depth': 3},
  'camera': {'look_at': {'eye': [0,2,4], 'target': [0,0,0]}}, 'materials': {'white': {'type': 'diffuse', 'reflectance': 0.7}},
  'meshes': {'plane': {'shape': 'rectangle'}, 'ball': {'shape': 'sphere', 'segments': 16}},
  'objects': [{'mesh': 'plane', 'material': 'white', 'transform': {'scale': [5,1,5]}},
    {'mesh': 'ball', 'material': 'white', 'transform': {'scale': [0.5,0.5,0.5], 'translate': [0,0.5,0]}},
    {'mesh': 'plane', 'material': 'white', 'emission': 5,
     'transform': {'rotate_deg': [180,0,0], 'translate': [0,3,0]}}]})";

TEST(SampleCounts, EachPixelIsThatOfAFrameWithSoManySamples) {
  const std::initializer_list<Aov> aovs{Aov::variance, Aov::albedo, Aov::depth, Aov::half_a, Aov::half_b};
  Image counts(24, 16, 1, 3.0f);
  for (int y = 0; y < 16; ++y) {
    for (int x = 12; x < 24; ++x) counts.at(x, y, 0) = 7.0f;
  }
  Scene scene = load_text(kLitFloor);
  RenderOptions adaptive = options(4, aovs);
  adaptive.sample_counts = &counts;
  RenderReport report;
  const Frame mixed = *render_frame(scene, 1, adaptive, &report);
  EXPECT_EQ(report.samples, 24u * 16u * 5u);
  // Textures are filtered for the 4 samples of the options; this scene has none.
  const Frame few = *render_frame(scene, 1, options(3, aovs));
  const Frame many = *render_frame(scene, 1, options(7, aovs));
  for (const Aov aov : {Aov::beauty, Aov::variance, Aov::albedo, Aov::depth, Aov::half_a, Aov::half_b}) {
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 24; ++x) {
        const auto expected = (x < 12 ? few : many).image(aov).pixel(x, y);
        EXPECT_TRUE(std::ranges::equal(mixed.image(aov).pixel(x, y), expected)) << x << ' ' << y;
      }
    }
  }
}

TEST(SampleCounts, ThatCannotBeAreRefused) {
  Scene scene = load_text(kLitFloor);
  const auto refused = [&](const Image& counts, std::initializer_list<Aov> aovs) {
    RenderOptions adaptive = options(4, aovs);
    adaptive.sample_counts = &counts;
    EXPECT_THROW(render_frame(scene, 1, adaptive), Error);
  };
  refused(Image(24, 16, 1, 0.0f), {});
  refused(Image(24, 16, 1, 65537.0f), {});
  refused(Image(24, 15, 1, 2.0f), {});
  refused(Image(), {});
  for (const float count :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Image counts(24, 16, 1, 2.0f);
    counts.at(5, 3, 0) = count;
    refused(counts, {});
  }
  refused(Image(24, 16, 1, 1.0f), {Aov::half_a});
}

}  // namespace
}  // namespace becalm::tracer::test
