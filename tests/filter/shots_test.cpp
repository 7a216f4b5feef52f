// What the filter does where one frame tells nothing of another.
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "filter/sequence/sequence_filter.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/moving_pattern.h"

namespace becalm::filter::shots_test {
namespace {

using namespace moving_pattern;

/// A frame of another shot: brighter, and without the pattern.
Frame other_shot(int number) {
  Frame frame = noisy_frame(number);
  std::ranges::fill(frame.image(Aov::albedo).data(), 0.9f);
  for (std::size_t i = 0; i < frame.image(Aov::beauty).data().size(); ++i) {
    if (i % 4 != 3) frame.image(Aov::beauty).data()[i] = 5.0f;
  }
  return frame;
}

class ShotsTest : public DeviceTest {
 protected:
  static SequenceFilter finding_cuts() {
    Settings settings = unsmoothed();
    settings.directions = Directions::forward;
    return {device(), settings, kWidth, kHeight, noisy_frame(1).aovs(), {.find_cuts = FindCuts::yes}};
  }
};

TEST_F(ShotsTest, APredictionFromAnotherShotHasNoPart) {
  for (const MergeMode mode : {MergeMode::variance, MergeMode::mask}) {
    Settings settings = unsmoothed();
    settings.merge = mode;
    SequenceFilter filter(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
    double error = -1.0;
    for (const Segment& segment : schedule(std::vector{1, 2}, {1}, {.segment = 8})) {
      for (const Step& step : segment) {
        FrameReport report;
        const Frame frame = step.frame == 1 ? noisy_frame(1) : other_shot(2);
        if (const std::optional<Frame> made = filter.run(step, frame, report)) error = squared_error(*made);
      }
    }
    EXPECT_GE(error, 0.0);
    EXPECT_LT(error, 1.1 * squared_error(noisy_frame(1)));
  }
}

TEST_F(ShotsTest, ACutIsFoundBehindAFrameOfWhichNothingIsKnown) {
  SequenceFilter filter = finding_cuts();
  EXPECT_FALSE(denoise_frame(filter, noisy_frame(1), true).report.new_shot);
  Frame unknown = noisy_frame(2);
  std::ranges::fill(unknown.image(Aov::beauty).data(), std::nanf(""));
  EXPECT_FALSE(denoise_frame(filter, unknown).report.new_shot);
  EXPECT_TRUE(denoise_frame(filter, other_shot(3)).report.new_shot);
}

TEST_F(ShotsTest, WhatBeginsANewHistoryIsNoCut) {
  SequenceFilter filter = finding_cuts();
  denoise_frame(filter, noisy_frame(1), true);
  EXPECT_FALSE(denoise_frame(filter, other_shot(9), true).report.new_shot);
  EXPECT_TRUE(denoise_frame(filter, noisy_frame(10)).report.new_shot);
}

TEST_F(ShotsTest, TheBiasThatIsToldIsARadiance) {
  const auto bias_of = [&](float scale) {
    SequenceFilter filter(device(), unsmoothed(), kWidth, kHeight, noisy_frame(1).aovs(),
                          {.diagnostics = aov_set({Aov::bias})});
    Frame made;
    for (Frame frame : {noisy_frame(1), other_shot(2)}) {
      for (float& value : frame.image(Aov::beauty).data()) value *= scale;
      for (float& value : frame.image(Aov::variance).data()) value *= scale * scale;
      made = denoise_frame(filter, frame).frame;
    }
    double sum = 0.0;
    for (const float value : made.image(Aov::bias).data()) sum += value / made.image(Aov::bias).data().size();
    return sum;
  };
  const double of_one = bias_of(1.0f);
  EXPECT_GT(of_one, 1.0);
  EXPECT_LT(of_one, 5.0);
  EXPECT_NEAR(bias_of(4.0f) / of_one, 4.0, 1e-3);
}

}  // namespace
}  // namespace becalm::filter::shots_test
