// What temporal antialiasing follows: vectors from where samples lie, of surfaces whose depth is known, and
// what the search finds whatever the scale of the radiance; and what it makes of the border.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "filter/antialias/antialias_filter.h"
#include "filter/antialias/checkerboard.h"
#include "filter/antialias/radiance_range.h"
#include "filter/antialias/sample_grid.h"
#include "shaders/shared/limits.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::antialias_vectors_test {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 32;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

AntialiasSettings with(const std::vector<const char*>& changes) {
  AntialiasSettings settings = antialias_preset("forward");
  for (const char* change : changes) set(settings, change);
  return settings;
}

Frame even(int number, float grey, float motion) {
  Frame frame(number, kWidth, kHeight);
  std::ranges::fill(frame.add(Aov::beauty).data(), grey);
  frame.add(Aov::motion, motion);
  return frame;
}

/// A texture that moves by 3 pixels a frame.
Frame textured(int number) {
  Frame frame(number, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      std::ranges::fill(beauty.pixel(x, y).first(3),
                        static_cast<float>(0.1 + pattern(x - 3.0 * number, y, 5)));
  }
  return frame;
}

SequenceOptions telling(Aov aov) {
  SequenceOptions options;
  options.diagnostics.set(static_cast<std::size_t>(aov));
  return options;
}

Frame run(AntialiasFilter& filter, const Frame& frame) {
  FrameReport report;
  return *filter.run({.frame = frame.number()}, frame, report);
}

/// The first of the frames, with what those after it predict.
Frame first_of(AntialiasFilter& filter, const std::vector<Frame>& frames) {
  FrameReport report;
  for (std::size_t i = frames.size(); i-- > 0;) {
    filter.run({.frame = frames[i].number(),
                .direction = Direction::backward,
                .new_history = i + 1 == frames.size()},
               frames[i], report);
  }
  return *filter.run({.frame = frames[0].number(), .new_history = true}, frames[0], report);
}

using AntialiasVectorsTest = DeviceTest;

TEST_F(AntialiasVectorsTest, TurnedAroundTheyLeadToWhereTheSampleWas) {
  const AntialiasSettings settings = with({"directions=both", "reproject=vectors"});
  Frame next = even(1, 0.5f, kUnknown);
  next.set_jitter(FrameJitter{.positions_px = {{0.4f, -0.4f}}});
  next.image(Aov::motion).at(20, 10, 0) = 0.3f;
  next.image(Aov::motion).at(20, 10, 1) = -0.3f;
  AntialiasFilter filter(device(), settings, kWidth, kHeight, next.aovs(), telling(Aov::sample_count));
  const Image count = first_of(filter, {even(0, 0.5f, kUnknown), next}).image(Aov::sample_count);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      ASSERT_EQ(count.at(x, y, 0) > 1.0f, x == 21 && y == 9) << x << ',' << y << ' ' << count.at(x, y, 0);
  }
}

TEST_F(AntialiasVectorsTest, PixelsOfUnknownDepthAreBehindAllOthers) {
  const AntialiasSettings settings = with({"reproject=vectors"});
  for (const float unknown : {0.0f, -1.0f, kUnknown}) {
    Frame first = even(0, 0.5f, 0.0f);
    first.add(Aov::depth, 10.0f);
    Frame second = first;
    second.image(Aov::depth).at(20, 10, 0) = unknown;
    second.image(Aov::motion).at(20, 10, 0) = 8.0f;
    AntialiasFilter filter(device(), settings, kWidth, kHeight, first.aovs(), telling(Aov::flow));
    run(filter, first);
    const Frame result = run(filter, second);
    for (const float offset : result.image(Aov::flow).data()) ASSERT_EQ(offset, 0.0f) << unknown;
  }
}

TEST_F(AntialiasVectorsTest, AFireflyDoesNotBlindTheSearch) {
  Frame second = textured(1);
  second.image(Aov::beauty).at(40, 28, 1) = 1e30f;
  AntialiasFilter filter(device(), with({}), kWidth, kHeight, second.aovs(), telling(Aov::flow));
  run(filter, textured(0));
  const Image flow = run(filter, second).image(Aov::flow);
  int found = 0, all = 0;
  for (int y = 8; y < kHeight - 8; ++y) {
    for (int x = 12; x < kWidth - 16; ++x, ++all) found += std::abs(flow.at(x, y, 0) + 3.0f) < 0.5f;
  }
  EXPECT_GT(found, 0.9 * all);
}

TEST_F(AntialiasVectorsTest, WhereTheMaskTakesNoHistoryItTakesNoPrediction) {
  const AntialiasSettings settings =
      with({"directions=both", "reproject=search", "accumulate=exponential", "mask=yes"});
  AntialiasFilter filter(device(), settings, kWidth, kHeight, textured(0).aovs(), telling(Aov::sample_count));
  const std::vector<Frame> still{textured(0), textured(0), textured(0)};
  const Frame result = first_of(filter, still);
  for (const float count : result.image(Aov::sample_count).data()) ASSERT_NEAR(count, 1.0f, 1e-3f);
}

TEST_F(AntialiasVectorsTest, PixelsThatAreNotFiniteAddNothingToTheHistory) {
  Frame first = even(0, 0.5f, 0.0f);
  first.image(Aov::beauty).at(20, 10, 1) = kUnknown;
  for (const char* accumulate : {"accumulate=exponential", "accumulate=gain", "accumulate=variance"}) {
    AntialiasFilter filter(device(), with({"reproject=vectors", "reconstruct=no", accumulate}), kWidth,
                           kHeight, first.aovs(), telling(Aov::sample_count));
    EXPECT_EQ(run(filter, first).image(Aov::sample_count).at(20, 10, 0), 0.0f) << accumulate;
    const float before = run(filter, even(1, 0.5f, 0.0f)).image(Aov::sample_count).at(20, 10, 0);
    EXPECT_EQ(before, 1.0f) << accumulate;
    EXPECT_EQ(run(filter, first).image(Aov::sample_count).at(20, 10, 0), before) << accumulate;
  }
}

TEST_F(AntialiasVectorsTest, TheBiasThatIsToldIsARadiance) {
  const auto bias_of = [](float light) {
    AntialiasFilter filter(device(), with({"reproject=vectors"}), kWidth, kHeight, even(0, 1.0f, 0.0f).aovs(),
                           telling(Aov::bias));
    // Darker in the upper half alone, so that the light has not changed.
    Frame second = even(1, light, 0.0f);
    for (int x = 0; x < kWidth; ++x) std::ranges::fill(second.image(Aov::beauty).pixel(x, 9), 0.25f * light);
    run(filter, even(0, light, 0.0f));
    return run(filter, second).image(Aov::bias).at(20, 9, 0);
  };
  const float of_one = bias_of(1.0f);
  EXPECT_GT(of_one, 0.1f);
  EXPECT_LT(of_one, 1.0f);
  EXPECT_FLOAT_EQ(bias_of(64.0f), 64.0f * of_one);
}

TEST_F(AntialiasVectorsTest, BeyondTheBorderThereAreNoSamples) {
  Frame frame = even(0, 0.0f, 0.0f);
  frame.set_jitter(FrameJitter{.positions_px = {{0.8f, 0.0f}}});
  for (int y = 0; y < kHeight; ++y) std::ranges::fill(frame.image(Aov::beauty).pixel(0, y), 1.0f);
  AntialiasFilter filter(device(), with({}), kWidth, kHeight, frame.aovs(), {});
  const Frame result = run(filter, frame);
  // Pixel 1 sees the sample of pixel 0 0.2 px to the left of its centre, and its own 0.8 px to the right.
  const double left = blackman_harris_window(0.2 / 1.5);
  const double right = blackman_harris_window(0.8 / 1.5);
  EXPECT_NEAR(result.image(Aov::beauty).at(1, 10, 0), left / (left + right), 1e-4);
}

TEST(SampleGridTest, FiltersNarrowerThanAPixelLeaveNoneWithoutSamples) {
  const SampleGrid narrow = sample_grid(FrameJitter{.positions_px = {{0.4f, -0.3f}}, .radius_px = 0.1f});
  EXPECT_GT(narrow.weights[4], 0.0f);
  EXPECT_EQ(narrow.weights,
            sample_grid(FrameJitter{.positions_px = {{0.4f, -0.3f}}, .radius_px = 0.5f}).weights);
}

TEST(SparseGridTest, ManySamplesWeighByTheMeanOfTheirFilters) {
  const auto columns = [](std::vector<Imath::V2f> positions) {
    return sparse_grid(FrameJitter{.positions_px = std::move(positions)}, {2, 1}, {{0, 0}, {7, 7}}, false)
        .columns;
  };
  const Imath::V2f left(-0.1f, 0.0f), right(0.2f, 0.0f);
  const std::vector<float> of_left = columns({left}), of_right = columns({right});
  const std::vector<float> of_all = columns({left, left, right});
  for (std::size_t i = 0; i < of_all.size() / 2; ++i)
    EXPECT_NEAR(of_all[i], (2.0f * of_left[i] + of_right[i]) / 3.0f, 1e-6f) << i;
}

TEST(CheckerboardTest, HolesFollowTheClosestOfTheirNeighbours) {
  for (const Imath::V2i& closest : {Imath::V2i(0, 1), {2, 1}, {1, 0}, {1, 2}}) {
    for (const float unknown : {9.0f, 0.0f, kUnknown}) {
      Frame frame(0, 3, 3);
      frame.add(Aov::depth, unknown);
      frame.add(Aov::motion, -1.0f);
      frame.image(Aov::depth).at(closest.x, closest.y, 0) = 2.0f;
      frame.image(Aov::motion).at(closest.x, closest.y, 0) = 5.0f;
      fill_holes(frame, Parity::odd);
      EXPECT_EQ(frame.image(Aov::motion).at(1, 1, 0), 5.0f)
          << closest.x << ',' << closest.y << ' ' << unknown;
      EXPECT_EQ(frame.image(Aov::depth).at(1, 1, 0), 2.0f);
    }
  }
}

TEST(RadianceRangeTest, FirefliesOfAnySizeLeaveWhatIsUsualInRange) {
  Image color(64, 64, 4, 1.0f);
  EXPECT_EQ(scale_of(color), 0.5f);
  color.at(3, 3, 1) = 1e30f;
  const float of_firefly = scale_of(color).value_or(0.0f);
  EXPECT_LT(of_firefly, 0.5f);
  std::ranges::fill(color.data(), 1e-8f);
  color.at(3, 3, 1) = std::numeric_limits<float>::max();
  EXPECT_GE(1e-8f * scale_of(color).value_or(0.0f), 0x1p-41f);
}

TEST(RadianceRangeTest, VariancesScaleByTheSquare) {
  Estimate estimate({1, 1}, 0);
  std::ranges::fill(estimate.color.data(), 3.0f);
  std::ranges::fill(estimate.stats.data(), 5.0f);
  rescale(estimate, 4.0f);
  EXPECT_EQ(estimate.color.at(0, 0, 0), 12.0f);
  EXPECT_EQ(estimate.color.at(0, 0, 3), 3.0f) << "alpha";
  EXPECT_EQ(estimate.stats.at(0, 0, 0), 80.0f);
  EXPECT_EQ(estimate.stats.at(0, 0, 1), 5.0f) << "a number of frames";
  rescale(estimate, 1e30f);
  EXPECT_EQ(estimate.stats.at(0, 0, 0), kLargestVariance);
}

}  // namespace
}  // namespace becalm::filter::antialias_vectors_test
