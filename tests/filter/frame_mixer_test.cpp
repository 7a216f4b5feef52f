// Nearly clean frames keep detail that their smoothed ones have lost; others do not change.
#include "filter/smooth/frame_mixer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "filter/input/host_images.h"
#include "filter/sequence/sequence_filter.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"

namespace becalm::filter::frame_mixer_test {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();
constexpr int kStripe = 2;

/// Fine stripes, which smoothing has lost.
float striped(int x) {
  return x / kStripe % 2 ? 1.1f : 0.9f;
}

/// Stripes with noise of this deviation.
Frame noisy_stripes(int width, int height, float deviation) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal(0, deviation);
  Frame frame(1, width, height);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float noise = normal(random);
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = striped(x) + noise;
    }
  }
  return frame;
}

/// An even estimate of it, the mean of `frames`, with one additive AOV that is as bright.
Estimate even(const Frame& frame, float frames = 1.0f) {
  Estimate estimate({frame.width(), frame.height()}, 1);
  std::ranges::fill(estimate.color.data(), 1.0f);
  std::ranges::fill(estimate.carried.front().data(), 1.0f);
  for (std::size_t i = 0; i < estimate.stats.data().size(); ++i)
    estimate.stats.data()[i] = i % 2 ? frames : 0.003f;
  return estimate;
}

double squared_error(const Image& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) sum += std::pow(image.at(x, y, c) - striped(x), 2);
    }
  }
  return sum;
}

class FrameMixerTest : public DeviceTest {
 protected:
  static FilterTask task_of(const Frame& frame) {
    return {.settings = preset("draft"),
            .full = {frame.width(), frame.height()},
            .used = {},
            .diagnostics = {},
            .guides = {},
            .additive = 1};
  }
  static Estimate mixed_by(FrameMixer& mixer, const Frame& frame, float frames = 1.0f) {
    const Image& beauty = frame.image(Aov::beauty);
    const NewFrame input{
        .frame = frame, .finite = finite_pixels(beauty), .exposure = exposure(beauty), .additive = {beauty}};
    Estimate estimate = even(frame, frames);
    FrameReport report;
    mixer.mix(input, estimate, report);
    return estimate;
  }
  static Estimate mixed(const Frame& frame, float frames = 1.0f) {
    FrameMixer mixer(device(), task_of(frame), kUnlimited);
    return mixed_by(mixer, frame, frames);
  }
};

TEST_F(FrameMixerTest, ANearlyCleanFrameKeepsDetail) {
  const Frame frame = noisy_stripes(48, 32, 0.03f);
  const Estimate before = even(frame);
  const Estimate after = mixed(frame);
  EXPECT_LT(squared_error(after.color), 0.5 * squared_error(before.color));
  for (std::size_t i = 0; i < after.stats.data().size(); i += 2) {
    ASSERT_GT(after.stats.data()[i], before.stats.data()[i]) << "the frame's difference is an error";
    ASSERT_EQ(after.stats.data()[i + 1], 1.0f);
  }
}

TEST_F(FrameMixerTest, AMeanOfManyFramesHasLostDetailRatherThanNoise) {
  const Frame frame = noisy_stripes(48, 32, 0.08f);
  const auto error_after = [&](float frames) { return squared_error(mixed(frame, frames).color); };
  EXPECT_LT(error_after(16.0f), 0.98 * error_after(1.0f));
}

TEST_F(FrameMixerTest, TheShareFallsToNothingWithoutAStep) {
  const auto change_of = [](float deviation) {
    const Frame frame = noisy_stripes(96, 64, deviation);
    const Image before = even(frame).color;
    const Image after = mixed(frame).color;
    double sum = 0.0;
    for (std::size_t i = 0; i < after.data().size(); ++i) sum += std::abs(after.data()[i] - before.data()[i]);
    return sum;
  };
  const double clean = change_of(0.08f);
  const double nearly_noisy = change_of(0.14f);
  EXPECT_GT(nearly_noisy, 0.0);
  EXPECT_LT(nearly_noisy, 0.25 * clean);
}

TEST_F(FrameMixerTest, ANoisyFrameLeavesItsEstimate) {
  const Frame frame = noisy_stripes(48, 32, 0.2f);
  const Estimate before = even(frame);
  const Estimate after = mixed(frame);
  EXPECT_TRUE(std::ranges::equal(after.color.data(), before.color.data()));
  EXPECT_TRUE(std::ranges::equal(after.stats.data(), before.stats.data()));
}

TEST_F(FrameMixerTest, AnEmptyBackgroundMakesNoFrameClean) {
  Frame frame = noisy_stripes(64, 32, 0.25f);
  Estimate estimate = even(frame);
  for (int y = 0; y < 32; ++y) {
    for (int x = 8; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(x, y, c) = estimate.color.at(x, y, c) = 0.0f;
    }
  }
  const Image& beauty = frame.image(Aov::beauty);
  const NewFrame input{
      .frame = frame, .finite = finite_pixels(beauty), .exposure = exposure(beauty), .additive = {beauty}};
  const Image before = estimate.color;
  FrameMixer mixer(device(), task_of(frame), kUnlimited);
  FrameReport report;
  mixer.mix(input, estimate, report);
  EXPECT_TRUE(std::ranges::equal(estimate.color.data(), before.data()));
}

TEST_F(FrameMixerTest, AFireflyMakesNoFrameNoisyAndStaysOut) {
  Frame frame = noisy_stripes(48, 32, 0.03f);
  for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(20, 10, c) = 1e6f;
  Estimate after = mixed(frame);
  EXPECT_LT(after.color.at(20, 10, 0), 30.0f);
  for (int c = 0; c < 4; ++c) after.color.at(20, 10, c) = striped(20);
  EXPECT_LT(squared_error(after.color), 0.6 * squared_error(even(frame).color));
}

TEST_F(FrameMixerTest, AdditiveAovsTakeTheSameShare) {
  const Estimate after = mixed(noisy_stripes(48, 32, 0.03f));
  EXPECT_TRUE(std::ranges::equal(after.carried.front().data(), after.color.data()));
}

TEST_F(FrameMixerTest, APixelThatIsNotFiniteTakesNoPart) {
  Frame frame = noisy_stripes(48, 32, 0.03f);
  const Estimate without = mixed(frame);
  frame.image(Aov::beauty).at(20, 10, 1) = std::numeric_limits<float>::quiet_NaN();
  const Estimate after = mixed(frame);
  EXPECT_EQ(after.color.at(20, 10, 1), 1.0f);
  for (const float value : after.color.data()) ASSERT_TRUE(std::isfinite(value));
  EXPECT_NEAR(squared_error(after.color), squared_error(without.color), 0.05 * squared_error(without.color));
}

TEST_F(FrameMixerTest, TilesShowNoSeams) {
  const Frame frame = noisy_stripes(405, 309, 0.03f);
  FrameMixer whole(device(), task_of(frame), kUnlimited);
  ASSERT_EQ(whole.memory().tiles, 1u);
  const std::uint64_t limit = whole.memory().device.total() / 2;
  FrameMixer tiled(device(), task_of(frame), limit);
  EXPECT_GE(tiled.memory().tiles, 2u);
  EXPECT_LE(tiled.memory().device.total(), limit);
  const Estimate a = mixed_by(whole, frame);
  const Estimate b = mixed_by(tiled, frame);
  EXPECT_TRUE(std::ranges::equal(a.color.data(), b.color.data()));
  EXPECT_TRUE(std::ranges::equal(a.stats.data(), b.stats.data()));
}

TEST_F(FrameMixerTest, DraftMixesNearlyCleanFramesOfUnknownNoise) {
  const auto mixes = [](float deviation, bool known) {
    Frame frame = noisy_stripes(48, 32, deviation);
    if (known) frame.add(Aov::variance, deviation * deviation);
    SequenceFilter filter(device(), preset("draft"), frame.width(), frame.height(), frame.aovs());
    const std::vector<gpu::PassTime> passes = denoise_frame(filter, frame).report.passes;
    return std::ranges::count(passes, "smooth/own_share own.share", &gpu::PassTime::name);
  };
  EXPECT_EQ(mixes(0.03f, false), 1);
  EXPECT_EQ(mixes(0.3f, false), 0);
  EXPECT_EQ(mixes(0.03f, true), 0);
}

}  // namespace
}  // namespace becalm::filter::frame_mixer_test
