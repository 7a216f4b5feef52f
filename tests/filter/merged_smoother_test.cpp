// Noisy frames that are merged with the weights of smoothed ones and then smoothed.
#include "filter/smooth/merged_smoother.h"

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "filter/sequence/sequence_filter.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::merged_smoother_test {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;
constexpr float kDeviation = 0.1f;

AovSet accumulated_aovs() {
  AovSet set;
  for (const Aov aov : {Aov::accumulated, Aov::accumulated_variance, Aov::sample_count}) {
    set.set(static_cast<std::size_t>(aov));
  }
  return set;
}

float clean(int x, int y) {
  return static_cast<float>(0.5 + pattern(x, y, 9));
}

/// A static pattern with grey noise and its variance.
Frame noisy_frame(int number) {
  std::mt19937 random(number);
  std::normal_distribution<float> normal(0, kDeviation);
  Frame frame(number, kWidth, kHeight);
  frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::variance, kDeviation * kDeviation);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float noise = normal(random);
      for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(x, y, c) = clean(x, y) + noise;
    }
  }
  return frame;
}

double squared_error(const Image& image) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) sum += std::pow(image.at(x, y, 1) - clean(x, y), 2);
  }
  return sum / (kWidth * kHeight);
}

double mean(const Image& image) {
  double sum = 0;
  for (const float value : image.data()) sum += value;
  return sum / static_cast<double>(image.data().size());
}

class MergedSmootherTest : public DeviceTest {
 protected:
  static Settings settings(Directions directions) {
    Settings settings = preset("balanced");
    settings.smooth = Smooth::merged;
    settings.directions = directions;
    return settings;
  }

  /// Frame `wanted` of `count` frames, denoised from all of them or from those up to it.
  static Frame denoised(Directions directions, int wanted, int count) {
    SequenceFilter filter(device(), settings(directions), kWidth, kHeight, noisy_frame(1).aovs(),
                          {.diagnostics = accumulated_aovs()});
    std::vector<int> frames;
    for (int number = 1; number <= count; ++number) frames.push_back(number);
    std::optional<Frame> result;
    for (const Segment& segment : schedule(frames, {wanted},
                                           {.directions = directions,
                                           .segment = directions == Directions::both ? 16 : 0,
                                           .warmup = directions == Directions::both ? 8 : 0})) {
      for (const Step& step : segment) {
        FrameReport report;
        std::optional<Frame> frame = filter.run(step, noisy_frame(step.frame), report);
        if (frame && frame->number() == wanted) result = std::move(frame);
      }
    }
    return std::move(*result);
  }
};

TEST_F(MergedSmootherTest, OneFrameIsMergedAsItCame) {
  const Frame noisy = noisy_frame(1);
  const Frame frame = denoised(Directions::forward, 1, 1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_EQ(frame.image(Aov::accumulated).at(x, y, 0), noisy.image(Aov::beauty).at(x, y, 0));
      ASSERT_EQ(frame.image(Aov::accumulated_variance).at(x, y, 0), kDeviation * kDeviation);
    }
  }
}

TEST_F(MergedSmootherTest, NoiseFallsWithTheFramesThatAreMergedAndIsKnown) {
  for (const Directions directions : {Directions::forward, Directions::both}) {
    const Frame frame = denoised(directions, 6, 10);
    const double error = squared_error(frame.image(Aov::accumulated));
    EXPECT_LT(error, 0.4 * kDeviation * kDeviation);
    const double told = mean(frame.image(Aov::accumulated_variance));
    EXPECT_GT(told, 0.5 * error);
    EXPECT_LT(told, 2.0 * error);
    EXPECT_LT(squared_error(frame.image(Aov::beauty)), error) << "what comes out is smoothed";
    EXPECT_GT(mean(frame.image(Aov::sample_count)), 2.0);
  }
}

TEST(AccumulatedTest, VarianceIsThatOfTheMeanOfAllFrames) {
  Estimate merged({2, 1}, FilterTask::kNoisyLayers);
  for (Image& layer : merged.carried) layer = Image(2, 1, 4, 0.5f);
  for (const float frames : {1.0f, 8.0f, 40.0f}) {
    merged.stats.data()[1] = merged.stats.data()[3] = frames;
    const Image variance = accumulated(merged).variance;
    for (const float value : variance.data()) EXPECT_EQ(value, 0.5f / frames);
  }
}

TEST_F(MergedSmootherTest, TheUnitOfDepthDoesNotMatter) {
  const auto beauty = [](float unit) {
    Frame frame = noisy_frame(1);
    frame.add(Aov::depth);
    SequenceFilter filter(device(), settings(Directions::forward), kWidth, kHeight, frame.aovs());
    Denoised result;
    for (int number = 1; number <= 2; ++number) {
      frame = noisy_frame(number);
      Image& depth = frame.add(Aov::depth);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) depth.at(x, y, 0) = unit * (x < kWidth / 2 ? 1.0f + 0.1f * y : 4.0f);
      }
      result = denoise_frame(filter, frame);
    }
    return result.frame.image(Aov::beauty);
  };
  const Image metres = beauty(1.0f);
  const Image centimetres = beauty(100.0f);
  for (std::size_t i = 0; i < metres.data().size(); ++i)
    ASSERT_NEAR(metres.data()[i], centimetres.data()[i], 1e-5f) << i;
}

TEST_F(MergedSmootherTest, FramesAfterItAddToWhatIsKnown) {
  EXPECT_LT(squared_error(denoised(Directions::both, 4, 8).image(Aov::accumulated)),
            0.8 * squared_error(denoised(Directions::forward, 4, 8).image(Aov::accumulated)));
}

TEST_F(MergedSmootherTest, AnEvenSequenceStaysAsItIs) {
  SequenceFilter filter(device(), settings(Directions::forward), 40, 24, {});
  Frame even(1, 40, 24);
  even.add(Aov::beauty, 0.75f);
  for (int number = 1; number <= 3; ++number) {
    const Denoised result = denoise_frame(filter, even);
    for (const float value : result.frame.image(Aov::beauty).data()) EXPECT_NEAR(value, 0.75f, 1e-5f);
  }
}

TEST_F(MergedSmootherTest, PixelsThatAreNotFiniteComeOutAsTheyCameAndReachNoOthers) {
  SequenceFilter filter(device(), settings(Directions::forward), kWidth, kHeight, noisy_frame(1).aovs());
  for (int number = 1; number <= 3; ++number) {
    Frame frame = noisy_frame(number);
    frame.image(Aov::beauty).at(10, 20, 1) = std::numeric_limits<float>::infinity();
    const Image result = denoise_frame(filter, frame).frame.image(Aov::beauty);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (x == 10 && y == 20) continue;
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(result.at(x, y, c))) << x << ", " << y;
      }
    }
    EXPECT_EQ(result.at(10, 20, 1), std::numeric_limits<float>::infinity());
    EXPECT_EQ(result.at(10, 20, 0), frame.image(Aov::beauty).at(10, 20, 0));
  }
}

}  // namespace
}  // namespace becalm::filter::merged_smoother_test
