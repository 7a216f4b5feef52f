#include "filter/sequence/sequence_filter.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <set>

#include "frame/error.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/moving_pattern.h"

namespace becalm::filter::sequence_filter_test {
namespace {

using namespace moving_pattern;

class SequenceFilterTest : public DeviceTest {};

TEST_F(SequenceFilterTest, CalmsAMovingPatternAndKeepsItsEnergy) {
  for (const char* name : {"draft", "balanced", "final"}) {
    SequenceFilter filter(device(), preset(name), kWidth, kHeight, noisy_frame(1).aovs());
    double noisy_error = 0, error = 0, energy = 0, clean_energy = 0;
    for (int number = 1; number <= 12; ++number) {
      const Frame noisy = noisy_frame(number);
      const Denoised denoised = denoise_frame(filter, noisy);
      EXPECT_EQ(denoised.frame.number(), number);
      if (number < 8) continue;
      noisy_error += squared_error(noisy);
      error += squared_error(denoised.frame);
      energy += mean(denoised.frame);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) clean_energy += clean(x, y, number) / (kWidth * kHeight);
      }
    }
    EXPECT_LT(error, noisy_error / 3) << name;
    EXPECT_NEAR(energy / clean_energy, 1.0, 0.0075) << name;
  }
}

TEST_F(SequenceFilterTest, MaskModeIsNeverWorseThanNoisyAndKeepsTheEnergy) {
  const std::vector<int> frames{1, 2, 3, 4, 5, 6, 7};
  for (const Directions directions : {Directions::forward, Directions::both}) {
    for (const Smooth smooth : {Smooth::none, Smooth::frames}) {
      Settings settings = preset("balanced");
      settings.merge = MergeMode::mask;
      settings.directions = directions;
      settings.smooth = smooth;
      SequenceFilter filter(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
      double energy = 0, clean_energy = 0;
      for (const Segment& segment :
           schedule(frames, {3, 4, 5}, {.directions = directions, .segment = 32, .warmup = 8})) {
        for (const Step& step : segment) {
          const Frame noisy = noisy_frame(step.frame);
          FrameReport report;
          const std::optional<Frame> denoised = filter.run(step, noisy, report);
          if (!denoised) continue;
          for (const float value : denoised->image(Aov::beauty).data()) ASSERT_TRUE(std::isfinite(value));
          EXPECT_LT(squared_error(*denoised), 0.7 * squared_error(noisy)) << step.frame;
          energy += mean(*denoised);
          for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) clean_energy += clean(x, y, step.frame) / (kWidth * kHeight);
          }
        }
      }
      ASSERT_GT(energy, 0.0);
      EXPECT_NEAR(energy / clean_energy, 1.0, 0.01);
    }
  }
}

TEST_F(SequenceFilterTest, ThePublishedMethodLowersTheNoise) {
  SequenceFilter filter(device(), preset("paper"), kWidth, kHeight, noisy_frame(1).aovs());
  double noisy_error = 0, error = 0;
  for (int number = 1; number <= 8; ++number) {
    const Frame noisy = noisy_frame(number);
    const Frame denoised = denoise_frame(filter, noisy).frame;
    if (number == 1) continue;
    noisy_error += squared_error(noisy);
    error += squared_error(denoised);
  }
  EXPECT_LT(error, 0.7 * noisy_error);
}

TEST_F(SequenceFilterTest, BothDirectionsAreBetterThanOneAndKeepTheEnergy) {
  const std::vector<int> frames{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  std::array<double, 2> error{};
  for (const Directions directions : {Directions::forward, Directions::both}) {
    Settings settings = preset("final");
    settings.directions = directions;
    SequenceFilter filter(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
    double energy = 0, clean_energy = 0;
    for (const Segment& segment :
         schedule(frames, {6, 7, 8}, {.directions = directions, .segment = 32, .warmup = 8})) {
      for (const Step& step : segment) {
        FrameReport report;
        const std::optional<Frame> denoised = filter.run(step, noisy_frame(step.frame), report);
        ASSERT_EQ(denoised.has_value(), step.wanted && step.direction == Direction::forward);
        if (!denoised) continue;
        error[static_cast<std::size_t>(directions)] += squared_error(*denoised);
        energy += mean(*denoised);
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) clean_energy += clean(x, y, step.frame) / (kWidth * kHeight);
        }
      }
    }
    EXPECT_NEAR(energy / clean_energy, 1.0, 0.0075);
  }
  EXPECT_LT(error[1], 0.85 * error[0]);
}

TEST_F(SequenceFilterTest, BackwardInTimeKnownMotionIsTurnedAround) {
  const auto with_motion = [](int number) {
    Frame frame = noisy_frame(number);
    frame.remove(Aov::albedo);
    Image& motion = frame.add(Aov::motion);
    for (std::size_t i = 0; i < motion.pixel_count(); ++i) {
      motion.data()[2 * i] = 2.0f;
      motion.data()[2 * i + 1] = -1.0f;
    }
    return frame;
  };
  Settings settings = preset("final");
  settings.motion = MotionUse::override_offset;
  SequenceFilter filter(device(), settings, kWidth, kHeight, with_motion(1).aovs());
  const std::vector<int> frames{1, 2, 3, 4};
  const auto error_of = [&](const std::set<int>& wanted, const std::vector<int>& present) {
    double error = 0.0;
    for (const Segment& segment : schedule(present, wanted, {.segment = 8})) {
      for (const Step& step : segment) {
        FrameReport report;
        const std::optional<Frame> denoised = filter.run(step, with_motion(step.frame), report);
        if (denoised) error += squared_error(*denoised);
      }
    }
    return error;
  };
  const double alone = error_of({1}, std::vector<int>{1});
  EXPECT_LT(error_of({1}, frames), 0.7 * alone) << "frames 2 to 4 were not found";
}

TEST_F(SequenceFilterTest, NothingIsKnownOfALastFrameFromTheFuture) {
  SequenceFilter both(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
  Settings settings = preset("balanced");
  settings.directions = Directions::forward;
  SequenceFilter forward(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
  const std::vector<int> frames{1, 2, 3};
  for (const Segment& segment : schedule(frames, {3}, {.segment = 8})) {
    for (const Step& step : segment) {
      FrameReport report;
      const std::optional<Frame> of_both = both.run(step, noisy_frame(step.frame), report);
      if (step.direction == Direction::backward) continue;
      const Frame of_forward = denoise_frame(forward, noisy_frame(step.frame)).frame;
      if (of_both) {
        EXPECT_TRUE(
            std::ranges::equal(of_both->image(Aov::beauty).data(), of_forward.image(Aov::beauty).data()));
      }
    }
  }
}

TEST_F(SequenceFilterTest, TheFirstFrameOfAHistoryIsTheInput) {
  SequenceFilter filter(
      device(), unsmoothed(), kWidth, kHeight, noisy_frame(1).aovs(),
      {.diagnostics = aov_set({Aov::sample_count, Aov::error_mask, Aov::flow, Aov::bias, Aov::gain})});
  for (const int number : {1, 5}) {
    const Frame noisy = noisy_frame(number);
    const Denoised denoised = denoise_frame(filter, noisy, /*new_history=*/number == 5);
    EXPECT_TRUE(
        std::ranges::equal(denoised.frame.image(Aov::beauty).data(), noisy.image(Aov::beauty).data()));
    EXPECT_EQ(denoised.report.mean_sample_count, 1.0);
    EXPECT_EQ(denoised.report.mean_rejected, 1.0);
    for (const auto& [aov, value] : {std::pair{Aov::bias, 0.0f}, {Aov::gain, 1.0f}}) {
      for (const float v : denoised.frame.image(aov).data()) ASSERT_EQ(v, value) << info(aov).name;
    }
    denoise_frame(filter, noisy_frame(number + 1));
  }
}

TEST_F(SequenceFilterTest, PredictionsAreThoseOfTheStepsWhateverFramesSayOfThemselves) {
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
  const Frame frame = noisy_frame(1);
  const std::vector<int> frames{4, 5, 6, 7};
  int combined = 0;
  for (const Segment& segment : schedule(frames, {4, 5, 6}, {.segment = 8})) {
    for (const Step& step : segment) {
      FrameReport report;
      filter.run(step, frame, report);
      combined += std::ranges::any_of(
          report.passes, [](const gpu::PassTime& pass) { return pass.name.starts_with("merge/combine "); });
    }
  }
  EXPECT_EQ(combined, 3);
}

TEST_F(SequenceFilterTest, EqualRunsGiveEqualBytes) {
  std::vector<float> first;
  for (int run = 0; run < 2; ++run) {
    SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
    Denoised denoised;
    for (int number = 1; number <= 3; ++number) denoised = denoise_frame(filter, noisy_frame(number));
    const auto data = denoised.frame.image(Aov::beauty).data();
    if (run == 0) first.assign(data.begin(), data.end());
    EXPECT_TRUE(std::ranges::equal(first, data));
  }
}

TEST_F(SequenceFilterTest, NothingDriftsOverThousandsOfFrames) {
  // The history is never reset, so rounding errors of each frame would add up.
  Settings settings = preset("draft");
  settings.smooth = Smooth::none;
  settings.patch_radius = 3;
  settings.pyramid.levels = 1;
  settings.motion = MotionUse::override_offset;
  constexpr int size = 8;
  constexpr int first_counted = 1000;
  constexpr int frames = 5000;
  SequenceFilter filter(device(), settings, size, size, aov_set({Aov::variance, Aov::motion}));
  std::mt19937 random(6);
  std::normal_distribution<float> noise(0.0f, 0.05f);
  Frame frame(1, size, size);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::variance, 0.05f * 0.05f);
  frame.add(Aov::motion);
  double of_inputs = 0;
  double of_outputs = 0;
  Denoised denoised;
  for (int number = 1; number <= frames; ++number) {
    for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        beauty.data()[4 * i + c] = 0.3f + 0.01f * static_cast<float>(i) + noise(random);
      }
    }
    denoised = denoise_frame(filter, frame);
    if (number < first_counted) continue;
    of_inputs += mean(frame);
    of_outputs += mean(denoised.frame);
  }
  EXPECT_GT(denoised.report.mean_sample_count, 32.0);
  EXPECT_NEAR(of_outputs / of_inputs, 1.0, 3e-5);
}

}  // namespace
}  // namespace becalm::filter::sequence_filter_test
