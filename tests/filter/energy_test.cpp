// Light that is missing in the output's large blocks is restored.
#include "filter/smooth/energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "filter/input/host_images.h"

namespace becalm::filter {
namespace {

constexpr float kNoise = 0.2f;

enum class Told { variance, halves, nothing };  ///< what the frame states about its noise

/// A frame of radiance 1 under noise.
Frame noisy_frame(int width, int height, Told told, float noise = kNoise) {
  std::mt19937 random(8);
  std::normal_distribution<float> normal(0, noise);
  Frame frame(1, width, height);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  if (told == Told::variance) frame.add(Aov::variance, noise * noise);
  if (told == Told::halves) {
    frame.add(Aov::half_a);
    frame.add(Aov::half_b);
  }
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = beauty.data()[4 * i + c] = 1 + normal(random);
      if (told != Told::halves) continue;
      const float difference = normal(random);
      frame.image(Aov::half_a).data()[3 * i + c] = value + difference;
      frame.image(Aov::half_b).data()[3 * i + c] = value - difference;
    }
  }
  return frame;
}

Estimate even_estimate(const Frame& frame, float value) {
  Estimate estimate({frame.width(), frame.height()}, 0);
  std::ranges::fill(estimate.color.data(), value);
  std::ranges::fill(estimate.stats.data(), 1.0f);
  return estimate;
}

void restore(const Frame& frame, Estimate& estimate) {
  const FilterTask task{.settings = preset("balanced"),
                        .full = {frame.width(), frame.height()},
                        .used = frame.aovs(),
                        .diagnostics = {},
                        .guides = {}};
  const Image& beauty = frame.image(Aov::beauty);
  restore_energy(
      {.frame = frame, .finite = finite_pixels(beauty), .exposure = exposure(beauty), .additive = {}}, task,
      estimate);
}

double mean_green(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.pixel_count(); ++i) sum += image.data()[4 * i + 1];
  return sum / static_cast<double>(image.pixel_count());
}

TEST(RestoreEnergy, GivesBackWhatNoiseDoesNotExplain) {
  for (const Told told : {Told::variance, Told::halves, Told::nothing}) {
    const Frame frame = noisy_frame(200, 150, told);
    for (const float value : {0.9f, 0.97f, 1.1f}) {
      Estimate estimate = even_estimate(frame, value);
      restore(frame, estimate);
      // The mean over 30,000 pixels has a standard error of 0.0012.
      EXPECT_NEAR(mean_green(estimate.color), mean_green(frame.image(Aov::beauty)), 0.003) << value;
    }
  }
}

TEST(RestoreEnergy, LightReturnsToWhereItIsMissing) {
  constexpr int size = 128;
  constexpr int first = 40;  // of the pixels where light is missing, along both axes
  constexpr int last = 79;
  constexpr int blurred = 24;  // factors are interpolated between blocks
  for (const Told told : {Told::variance, Told::halves, Told::nothing}) {
    const Frame frame = noisy_frame(size, size, told);
    Estimate estimate = even_estimate(frame, 1.0f);
    for (int y = first; y <= last; ++y) {
      for (int x = first; x <= last; ++x) std::fill_n(estimate.color.pixel(x, y).begin(), 3, 0.7f);
    }
    restore(frame, estimate);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const int outside = std::max({first - x, x - last, first - y, y - last});
        const float green = estimate.color.pixel(x, y)[1];
        if (outside > blurred) {
          ASSERT_NEAR(green, 1.0f, 0.03f) << x << "," << y;
        }
        if (outside < -8) {
          // Near the edge light goes to its bright side first.
          ASSERT_NEAR(green, 1.0f, outside < -10 ? 0.15f : 0.165f) << x << "," << y;
        }
      }
    }
  }
}

TEST(RestoreEnergy, ADarkBlockIsAsNoisyAsItsSurroundingsAlsoAtTheEdge) {
  constexpr int block = 16;
  // In an image of one column of blocks a block of twice the size has two of four parts.
  Frame frame(1, block, 2 * block);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance, 1.75f);
  for (int y = block; y < 2 * block; ++y) {
    for (int x = 0; x < block; ++x) {
      std::fill_n(beauty.pixel(x, y).begin(), 3, 0.9f);
      std::fill_n(variance.pixel(x, y).begin(), 3, 1e-4f);
    }
  }
  Estimate estimate = even_estimate(frame, 1.0f);
  restore(frame, estimate);
  for (std::size_t i = 0; i < estimate.color.pixel_count(); ++i) {
    ASSERT_GT(estimate.color.data()[4 * i + 1], 0.985f) << "pixel " << i;
  }
}

TEST(RestoreEnergy, NoiseHardlyMovesAnExactEstimate) {
  for (const Told told : {Told::variance, Told::halves, Told::nothing}) {
    const Frame frame = noisy_frame(200, 150, told);
    Estimate estimate = even_estimate(frame, 1.0f);
    restore(frame, estimate);
    // The mean of a block of 16 px has a standard error of 0.2 / 16; only twice that changes anything.
    for (std::size_t i = 0; i < estimate.color.pixel_count(); ++i) {
      ASSERT_NEAR(estimate.color.data()[4 * i + 1], 1.0f, 0.03f) << "pixel " << i;
    }
  }
}

TEST(RestoreEnergy, LightOfRareBrightSamplesIsInTheWholeFrame) {
  Frame frame = noisy_frame(320, 240, Told::halves);
  std::mt19937 random(3);
  std::bernoulli_distribution bright(0.02);
  for (std::size_t i = 0; i < frame.image(Aov::beauty).pixel_count(); ++i) {
    if (!bright(random)) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      frame.image(Aov::beauty).data()[4 * i + c] += 10;
      frame.image(Aov::half_a).data()[3 * i + c] += 20;
    }
  }
  // Of the 300 blocks, those with more bright samples are noisier.
  const double mean = mean_green(frame.image(Aov::beauty));
  Estimate estimate = even_estimate(frame, static_cast<float>(mean));
  restore(frame, estimate);
  EXPECT_NEAR(mean_green(estimate.color), mean, 0.002 * mean);
}

TEST(RestoreEnergy, CleanPixelsKeepTheirBrightnessBesideNoisyOnes) {
  // One block: the left half is noisy and has lost 5 % of its light, the right half is clean and exact.
  Frame frame = noisy_frame(128, 96, Told::nothing);
  Estimate estimate = even_estimate(frame, 1.0f);
  double noisy_mean = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 128; ++x) {
      if (x < 64) noisy_mean += frame.image(Aov::beauty).at(x, y, 1) / (64.0 * 96.0);
      for (int c = 0; c < 3; ++c)
        (x < 64 ? estimate.color : frame.image(Aov::beauty)).at(x, y, c) = x < 64 ? 0.95f : 1.0f;
    }
  }
  restore(frame, estimate);
  double restored_mean = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 64; ++x) restored_mean += estimate.color.at(x, y, 1) / (64.0 * 96.0);
    for (int x = 65; x < 128; ++x) ASSERT_NEAR(estimate.color.at(x, y, 1), 1.0f, 1e-4f) << x << ", " << y;
  }
  EXPECT_NEAR(restored_mean, noisy_mean, 0.01);
}

TEST(RestoreEnergy, NoiseThatIsToldButNotThereIsNotWaitedFor) {
  // The variance of one sample, given as its square, is 25 times the frame's true variance; the other
  // variances are invalid or missing.
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [told, variance] : {std::pair{Told::variance, 1.0f},
                                       {Told::variance, nan},
                                       {Told::variance, -1.0f},
                                       {Told::nothing, 0.0f}}) {
    SCOPED_TRACE(variance);
    Frame frame = noisy_frame(96, 80, told);
    if (told == Told::variance) std::ranges::fill(frame.image(Aov::variance).data(), variance);
    const double mean = mean_green(frame.image(Aov::beauty));
    Estimate estimate = even_estimate(frame, static_cast<float>(0.993 * mean));
    restore(frame, estimate);
    EXPECT_NEAR(mean_green(estimate.color), mean, 0.002 * mean);
  }
}

TEST(RestoreEnergy, TheWholeFramesMeanIsKeptBeyondItsNoise) {
  // The frame's mean has a standard error of 0.12 %, and so small a change is not seen.
  for (const Told told : {Told::variance, Told::halves}) {
    const Frame frame = noisy_frame(200, 150, told);
    const double mean = mean_green(frame.image(Aov::beauty));
    Estimate estimate = even_estimate(frame, static_cast<float>(mean - 0.002));
    restore(frame, estimate);
    EXPECT_NEAR(mean_green(estimate.color), mean, 3e-4);
  }
}

TEST(RestoreEnergy, WhatIsRightIsHardlyBrightenedForWhatIsMissingElsewhere) {
  // A sun has most of the light, and a fifth of it is missing. It lies in the corner of a block, where the
  // factors of four blocks meet, so the missing light cannot all be restored there.
  Frame frame(1, 1024, 256);
  frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::variance, 0.0f);
  Estimate estimate = even_estimate(frame, 1.0f);
  for (int c = 0; c < 3; ++c) {
    frame.image(Aov::beauty).at(895, 127, c) = 2400000.0f;
    estimate.color.at(895, 127, c) = 1920000.0f;
  }
  restore(frame, estimate);
  EXPECT_LT(estimate.color.at(895, 127, 1), 2240000.0f) << "nothing is missing any more";
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 512; ++x) {
      ASSERT_NEAR(estimate.color.at(x, y, 1), 1.0f, 0.0101f) << x << ',' << y;
    }
  }
}

TEST(RestoreEnergy, ADarkGroundHardlyGainsTheLightOfABrightThing) {
  // Noise of 20 %. A bright square has lost a third of its light, the ground nothing.
  constexpr int size = 128;
  constexpr float ground = 0.25f;
  constexpr float bright = 8.0f;
  const auto in_square = [](int x, int y) { return std::max(std::abs(x - 56), std::abs(y - 56)) <= 5; };
  Frame frame = noisy_frame(size, size, Told::nothing);
  Estimate estimate = even_estimate(frame, ground);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(x, y, c) *= in_square(x, y) ? bright : ground;
      if (in_square(x, y)) std::fill_n(estimate.color.pixel(x, y).begin(), 3, bright / 1.5f);
    }
  }
  restore(frame, estimate);
  double square = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float green = estimate.color.pixel(x, y)[1];
      if (in_square(x, y)) {
        square += green / 121.0;
      } else {
        ASSERT_LT(green, 1.05f * ground) << x << ',' << y;
      }
    }
  }
  EXPECT_NEAR(square, bright, 0.1 * bright);
}

TEST(RestoreEnergy, LandIsNotBrightenedBeyondItsNoiseForASunThatLostLight) {
  Frame frame = noisy_frame(256, 192, Told::variance);  // noise of 20 %
  Estimate estimate = even_estimate(frame, 1.0f);
  for (int x = 60; x < 64; ++x) {
    for (int c = 0; c < 3; ++c) {
      frame.image(Aov::beauty).at(x, 40, c) = 500000.0f;
      frame.image(Aov::variance).at(x, 40, c) = 1e6f;
      estimate.color.at(x, 40, c) = 400000.0f;
    }
  }
  restore(frame, estimate);
  for (int y = 0; y < 192; ++y) {
    for (int x = 0; x < 256; ++x) {
      const bool beside_the_sun = std::abs(x - 62) < 24 && std::abs(y - 40) < 24;  // in its cells
      if (beside_the_sun) continue;
      ASSERT_LT(estimate.color.at(x, y, 1), 1.0f + kNoise) << x << ',' << y;
    }
  }
}

TEST(RestoreEnergy, FramesWithLittleNoiseLoseLightButHardlyGainAny) {
  constexpr float little = 0.03f;
  const Frame frame = noisy_frame(200, 150, Told::variance, little);
  Estimate bright = even_estimate(frame, 1.05f);
  restore(frame, bright);
  EXPECT_NEAR(mean_green(bright.color), mean_green(frame.image(Aov::beauty)), 0.003);
  // Samples that are brighter by 25 % and have this root mean square add (0.05^2 + 0.03^2) / 0.25.
  Estimate dark = even_estimate(frame, 0.95f);
  restore(frame, dark);
  EXPECT_GT(mean_green(dark.color), 0.955);
  EXPECT_LT(mean_green(dark.color), 0.98);
}

TEST(RestoreEnergy, ABrightLineBesideBlackKeepsItsLight) {
  // 1 % of noise on a line; what smoothing leaves beside it is certainly too much, for black has no noise.
  for (const float trace : {1e-20f, 1e-6f}) {
    for (const int row : {20, 28, 31, 32, 36}) {
      Frame frame = noisy_frame(96, 64, Told::variance, 0.01f);
      Estimate estimate = even_estimate(frame, trace);
      for (int y = 0; y < frame.height(); ++y) {
        for (int x = 0; x < frame.width(); ++x) {
          const bool is_line = y == row && x >= 20 && x < 70;
          for (int c = 0; c < 3; ++c) {
            if (is_line) {
              estimate.color.at(x, y, c) = 1.0f;
            } else {
              frame.image(Aov::beauty).at(x, y, c) = frame.image(Aov::variance).at(x, y, c) = 0.0f;
            }
          }
        }
      }
      restore(frame, estimate);
      double sum = 0.0;
      for (int x = 20; x < 70; ++x) sum += estimate.color.at(x, row, 1) / 50.0;
      EXPECT_NEAR(sum, 1.0, 0.01) << "row " << row << ", trace " << trace;
    }
  }
}

TEST(RestoreEnergy, AnEqualEstimateStaysBitForBit) {
  for (const Told told : {Told::variance, Told::halves, Told::nothing}) {
    const Frame frame = noisy_frame(70, 45, told);
    Estimate estimate = even_estimate(frame, 1.0f);
    estimate.color = frame.image(Aov::beauty);
    restore(frame, estimate);
    EXPECT_TRUE(std::ranges::equal(estimate.color.data(), frame.image(Aov::beauty).data()));
  }
}

TEST(RestoreEnergy, LightOfAFewSamplesHardlyBrightensTheirBlock) {
  // Nine samples of a block have twice the light of all others: 3 deviations of the sum of nine such samples.
  constexpr int block = 16;
  Frame frame = noisy_frame(128, 128, Told::nothing, 0.05f);
  for (int i = 0; i < 9; ++i) std::fill_n(frame.image(Aov::beauty).pixel(66 + i, 70).begin(), 3, 64.0f);
  Estimate estimate = even_estimate(frame, 1.0f);
  restore(frame, estimate);
  double light = 0.0;
  for (int y = 64; y < 64 + block; ++y) {
    for (int x = 64; x < 64 + block; ++x) light += estimate.color.pixel(x, y)[1];
  }
  EXPECT_GT(light / (block * block), 1.02);
  EXPECT_LT(light / (block * block), 1.2);
}

TEST(RestoreEnergy, AFrameWithoutBrightnessIsLeft) {
  Frame frame(1, 300, 200);
  Image& beauty = frame.add(Aov::beauty);
  for (std::size_t i = 0; i < beauty.data().size(); ++i) beauty.data()[i] = i / 4 % 2 == 0 ? 1.0f : -1.0f;
  Estimate estimate = even_estimate(frame, 0.25f);
  estimate.carried.emplace_back(300, 200, 4, 2.0f);
  restore(frame, estimate);
  EXPECT_TRUE(std::ranges::all_of(estimate.color.data(), [](float v) { return v == 0.25f; }));
  EXPECT_TRUE(std::ranges::all_of(estimate.carried[0].data(), [](float v) { return v == 2.0f; }));
}

TEST(RestoreEnergy, ExtremesStayFiniteInImagesOfAnySize) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 70}, {33, 32}}) {
    for (const float of_frame : {0.0f, -1.0f, 1e-30f, 1.0f, 1e30f}) {
      for (const float of_estimate : {0.0f, -1.0f, 1e-30f, 1.0f, 1e30f}) {
        for (const Told told : {Told::variance, Told::nothing}) {
          Frame frame = noisy_frame(width, height, told);
          std::ranges::fill(frame.image(Aov::beauty).data(), of_frame);
          if (height > 1) frame.image(Aov::beauty).at(0, 3, 1) = nan;
          if (height > 1 && told == Told::variance) {
            frame.image(Aov::variance).at(0, 5, 1) = nan;
            frame.image(Aov::variance).at(0, 6, 1) = -1.0f;
          }
          Estimate estimate = even_estimate(frame, of_estimate);
          restore(frame, estimate);
          for (const float v : estimate.color.data()) {
            ASSERT_TRUE(std::isfinite(v))
                << width << 'x' << height << ": " << of_frame << ", " << of_estimate;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace becalm::filter
