// Smoothing of single frames: what it keeps, what it removes, and what it does not depend on.
#include "filter/smooth/frame_smoother.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "filter/input/host_images.h"
#include "filter/sequence/sequence_filter.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

FilterTask task_of(const Frame& frame, const Settings& settings = preset("balanced")) {
  return {.settings = settings,
          .full = {frame.width(), frame.height()},
          .used = frame.aovs() & wanted_aovs(settings),
          .diagnostics = {},
          .guides = {}};
}

class FrameSmootherTest : public DeviceTest {
 protected:
  static Estimate run(FrameSmoother& smoother, const Frame& frame, float noise_ratio = 1.0f) {
    const Image& beauty = frame.image(Aov::beauty);
    const NewFrame input{.frame = frame,
                         .finite = finite_pixels(beauty),
                         .exposure = exposure(beauty),
                         .usual_depth = typical_depth(frame, frame.aovs()),
                         .noise_ratio = noise_ratio,
                         .additive = {}};
    FrameReport report;
    return smoother.smooth(input, report);
  }
  static Estimate smooth(const Frame& frame, const Settings& settings = preset("balanced")) {
    FrameSmoother smoother(device(), task_of(frame, settings), kUnlimited);
    return run(smoother, frame);
  }
};

/// A chequered albedo under even light of radiance 2, with noise and its variance.
Frame textured_frame(int width, int height, float noise, int cell_width = 2, int cell_height = 3) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal(0, noise);
  Frame frame(1, width, height);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& albedo = frame.add(Aov::albedo);
  Image& variance = frame.add(Aov::variance);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float a = albedo.at(x, y, c) = (x / cell_width + y / cell_height + c) % 2 ? 0.8f : 0.2f;
        beauty.at(x, y, c) = 2 * a * (1 + normal(random));
        variance.at(x, y, c) = std::pow(2 * a * noise, 2.0f);
      }
    }
  }
  return frame;
}

double squared_error(const Image& image, const Image& albedo) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) sum += std::pow(image.at(x, y, c) - 2 * albedo.at(x, y, c), 2);
    }
  }
  return sum;
}

TEST_F(FrameSmootherTest, TextureOfTheAlbedoStaysAndNoiseGoes) {
  const Frame frame = textured_frame(48, 40, 0.3f);
  const Estimate smoothed = smooth(frame);
  const Image& albedo = frame.image(Aov::albedo);
  EXPECT_LT(squared_error(smoothed.color, albedo), squared_error(frame.image(Aov::beauty), albedo) / 5);
}

TEST_F(FrameSmootherTest, NoiseThatNeighboursShareGoesByWeightsOfItsOwn) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  Frame frame(1, 64, 48);
  Image samples(frame.width() + 2, frame.height() + 2, 3);
  for (float& sample : samples.data()) sample = 2.0f + normal(random);
  Image& beauty = frame.add(Aov::beauty);
  std::ranges::fill(frame.add(Aov::albedo).data(), 0.5f);
  std::ranges::fill(frame.add(Aov::normal).data(), 0.5f);
  std::ranges::fill(frame.add(Aov::depth).data(), 3.0f);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int tap = 0; tap < 9; ++tap) {
          const float weight = (tap % 3 == 1 ? 0.7f : 0.15f) * (tap / 3 == 1 ? 0.7f : 0.15f);
          sum += weight * samples.at(x + tap % 3, y + tap / 3, c);
        }
        beauty.at(x, y, c) = sum;
      }
    }
  }
  FrameSmoother smoother(device(), task_of(frame), kUnlimited);
  const auto error_with = [&](float noise_ratio) {
    const Image result = run(smoother, frame, noise_ratio).color;
    double sum = 0;
    for (std::size_t i = 0; i < result.data().size(); ++i)
      sum += i % 4 < 3 ? std::pow(result.data()[i] - 2.0, 2) : 0.0;
    return sum;
  };
  const double by_weights_for_independent = error_with(1.0f);
  EXPECT_LT(error_with(3.5f), 0.5 * by_weights_for_independent);
  EXPECT_EQ(error_with(1.0f), by_weights_for_independent);
}

TEST_F(FrameSmootherTest, TextureThatNothingExplainsStaysWhereThereIsLittleNoise) {
  // A frame of many samples, from a renderer that writes only the beauty.
  const Frame full = textured_frame(48, 40, 0.02f, 3, 40);  // stripes
  Frame frame(1, full.width(), full.height());
  frame.add(Aov::beauty) = full.image(Aov::beauty);
  const Image& albedo = full.image(Aov::albedo);
  EXPECT_LT(squared_error(smooth(frame).color, albedo),
            1.05 * squared_error(frame.image(Aov::beauty), albedo));
}

TEST_F(FrameSmootherTest, WhatIsBesideTheSunTakesNothingOfIt) {
  // At the disc's edge some of four samples hit the sun, which raises the sample variance; the sky beside it
  // is clean.
  constexpr float sun = 50000.0f;
  constexpr float sky = 1.5f;
  std::mt19937 random(8);
  std::binomial_distribution<int> hits(4, 0.4);
  Frame frame(1, 32, 32);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance);
  const auto distance = [](int x, int y) { return std::hypot(x - 15.5f, y - 15.5f); };
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const float share = distance(x, y) < 3 ? 1.0f : distance(x, y) < 4 ? hits(random) / 4.0f : 0.0f;
      for (int c = 0; c < 3; ++c) {
        beauty.at(x, y, c) = sky + sun * share;
        variance.at(x, y, c) = 1e-5f + sun * sun * share * (1 - share) / 3;
      }
    }
  }
  const Estimate smoothed = smooth(frame);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      // Kernels' weights are never zero: pixels next to the disc get some of its light, farther pixels a part
      // of the light that is restored over the whole block.
      const float limit = distance(x, y) < 4 ? kInf : distance(x, y) < 5.5f ? 8 * sky : 1.1f * sky;
      ASSERT_LT(smoothed.color.at(x, y, 0), limit) << x << ',' << y;
    }
  }
}

/// Radiance of 1 with noise, and one pixel with another value and variance.
Frame with_one_pixel(float value, float variance_there) {
  constexpr float noise = 0.1f;
  std::mt19937 random(4);
  std::normal_distribution<float> normal(1, noise);
  Frame frame(1, 24, 24);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance, noise * noise);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const float light = normal(random);
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = light;
    }
  }
  for (int c = 0; c < 3; ++c) {
    beauty.at(12, 12, c) = value;
    variance.at(12, 12, c) = variance_there;
  }
  return frame;
}

TEST_F(FrameSmootherTest, ALoneBrightSampleIsSmoothedAndAPointOfLightStays) {
  const Frame speck = with_one_pixel(2.2f, 0.04f);
  const Frame star = with_one_pixel(20.0f, 1e-5f);
  FrameSmoother smoother(device(), task_of(speck), kUnlimited);
  EXPECT_LT(run(smoother, speck).color.at(12, 12, 0), 1.3f);
  EXPECT_GT(run(smoother, star).color.at(12, 12, 0), 15.0f);
}

TEST_F(FrameSmootherTest, AGlintThatTheNoiseRulesOutStays) {
  const Frame glint = with_one_pixel(3.4f, 0.01f);  // 24 standard deviations of its own and of its neighbours
  EXPECT_GT(smooth(glint).color.at(12, 12, 0), 3.2f);
}

TEST_F(FrameSmootherTest, AnEvenImageStaysAsItIs) {
  Frame frame(1, 24, 20);
  frame.add(Aov::beauty, 0.37f);
  frame.add(Aov::variance, 0.01f);
  const Estimate smoothed = smooth(frame);
  for (const float v : smoothed.color.data()) ASSERT_NEAR(v, 0.37f, 1e-6f);
  for (std::size_t i = 0; i < smoothed.stats.pixel_count(); ++i) {
    ASSERT_GT(smoothed.stats.data()[2 * i], 0.0f);
    ASSERT_LE(smoothed.stats.data()[2 * i], 0.01f / 16) << "at least 4x4 pixels are averaged";
  }
}

TEST_F(FrameSmootherTest, KeepsTheEnergyOfSkewedNoise) {
  // Sample means of an exponential distribution, whose estimated variances are correlated with them: bright
  // pixels appear noisier, and weights from these variances lose light.
  std::mt19937 random(4);
  std::exponential_distribution<float> exponential;
  Frame frame(1, 96, 64);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance);
  double before = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const auto value = static_cast<float>(0.1 + pattern(x, y, 9));
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        float squares = 0;
        for (int s = 0; s < 4; ++s) {
          const float radiance = value * exponential(random);
          sum += radiance;
          squares += radiance * radiance;
        }
        beauty.at(x, y, c) = sum / 4;
        variance.at(x, y, c) = (squares - sum * sum / 4) / 12;
        before += beauty.at(x, y, c);
      }
    }
  }
  const Estimate smoothed = smooth(frame);
  double after = 0;
  for (std::size_t i = 0; i < smoothed.color.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) after += smoothed.color.data()[4 * i + c];
  }
  EXPECT_NEAR(after / before, 1.0, 0.03);
}

TEST_F(FrameSmootherTest, IsRefusedWhereTheSmallestTilesAreTooLarge) {
  EXPECT_THROW(FrameSmoother(device(), task_of(textured_frame(64, 64, 0.3f)), 1000), gpu::DeviceLimitError);
}

/// Extreme values, each put into some pixels of one AOV, must not make any result non-finite.
TEST_F(FrameSmootherTest, ExtremesStayFinite) {
  Frame frame = textured_frame(40, 24, 0.3f);
  for (const Aov aov : {Aov::normal, Aov::depth}) frame.add(aov, 0.5f);
  FrameSmoother smoother(device(), task_of(frame), kUnlimited);
  Frame halved = frame;
  halved.remove(Aov::variance);
  for (const Aov half : {Aov::half_a, Aov::half_b}) halved.image(half) = frame.image(Aov::albedo);
  FrameSmoother smoother_of_halves(device(), task_of(halved), kUnlimited);
  const auto expect_finite = [&](const Frame& input, const char* what) {
    const Estimate smoothed = run(input.has(Aov::half_a) ? smoother_of_halves : smoother, input);
    const std::vector<std::uint8_t> finite = finite_pixels(input.image(Aov::beauty));
    for (std::size_t i = 0; i < finite.size(); ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        ASSERT_TRUE(std::isfinite(smoothed.color.data()[4 * i + c])) << what << ", pixel " << i;
      }
      const float variance = smoothed.stats.data()[2 * i];
      ASSERT_TRUE(std::isfinite(variance) && variance >= 0.0f) << what << ", pixel " << i;
      ASSERT_EQ(smoothed.stats.data()[2 * i + 1], finite[i]) << what << ", pixel " << i;
    }
  };
  for (const Aov aov : {Aov::beauty, Aov::albedo, Aov::normal, Aov::depth, Aov::variance, Aov::half_a}) {
    for (const float bad : {kNan, kInf, -kInf, 1e30f, -1e30f, 1e-30f, 0.0f, -0.5f}) {
      Frame poisoned = aov == Aov::half_a ? halved : frame;
      for (int i = 0; i < 12; ++i) poisoned.image(aov).at(3 * i + 2, (7 * i) % 24, 0) = bad;
      expect_finite(poisoned, info(aov).name.data());
    }
  }
  Frame wide = frame;
  for (std::size_t i = 0; i < wide.image(Aov::beauty).pixel_count(); ++i) {
    for (float& v : wide.image(Aov::beauty).data().subspan(4 * i, 3)) v *= i % 3 == 0 ? 1e30f : 1e-30f;
  }
  expect_finite(wide, "1e-30 and 1e30 in one image");
  for (const float variance : {0.0f, 3e38f, kInf}) {
    Frame all = frame;
    std::ranges::fill(all.image(Aov::variance).data(), variance);
    expect_finite(all, "variance");
  }
  Frame black = frame;
  std::ranges::fill(black.image(Aov::beauty).data(), 0.0f);
  expect_finite(black, "black");
  const Estimate none = run(smoother, black);
  for (std::size_t i = 0; i < none.color.data().size(); ++i) ASSERT_EQ(none.color.data()[i], 0.0f) << i;
}

TEST_F(FrameSmootherTest, SizesFromOnePixelUp) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 16}, {64, 1}}) {
    Frame frame(1, width, height);
    frame.add(Aov::beauty, 0.37f);
    const Estimate smoothed = smooth(frame);
    for (const float v : smoothed.color.data()) ASSERT_NEAR(v, 0.37f, 1e-6f) << width << 'x' << height;
  }
}

TEST_F(FrameSmootherTest, TilesShowNoSeams) {
  Frame frame = textured_frame(613, 415, 0.3f);
  frame.image(Aov::beauty).at(70, 80, 1) = kNan;
  FrameSmoother whole(device(), task_of(frame), kUnlimited);
  ASSERT_EQ(whole.memory().tiles, 1u);
  const std::uint64_t limit = whole.memory().device.total() * 9 / 10;
  FrameSmoother tiled(device(), task_of(frame), limit);
  EXPECT_GE(tiled.memory().tiles, 2u);
  EXPECT_LE(tiled.memory().device.total(), limit);
  const Estimate a = run(whole, frame);
  const Estimate b = run(tiled, frame);
  EXPECT_TRUE(std::ranges::equal(a.color.data(), b.color.data()));
  EXPECT_TRUE(std::ranges::equal(a.stats.data(), b.stats.data()));
}

TEST_F(FrameSmootherTest, WhatHasHardlyAnyNoiseComesOutAsItWentIn) {
  // A frame as from a thousand samples: detail that no feature explains is put back.
  const Frame frame = textured_frame(64, 48, 0.01f, 3, 40);
  Frame beauty(1, frame.width(), frame.height());
  beauty.add(Aov::beauty) = frame.image(Aov::beauty);
  beauty.add(Aov::variance) = frame.image(Aov::variance);
  const Image& albedo = frame.image(Aov::albedo);
  EXPECT_LT(squared_error(smooth(beauty).color, albedo),
            1.05 * squared_error(frame.image(Aov::beauty), albedo));
}

}  // namespace
}  // namespace becalm::filter
