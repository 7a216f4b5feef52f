#include "filter/sequence/sequence_filter.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "frame/error.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

AovSet aov_set(std::initializer_list<Aov> aovs) {
  AovSet set;
  for (const Aov aov : aovs) set.set(static_cast<std::size_t>(aov));
  return set;
}

/// The clean value of a pattern that moves by (2, -1) px a frame.
double clean(int x, int y, int number) {
  return 0.1 + pattern(x + 2.0 * number, y - 1.0 * number, 9);
}

/// A frame of that animation with skewed noise (an exponential sample mean, as of rare bright paths) of 4
/// samples.
Frame noisy_frame(int number) {
  std::mt19937 random(number + 1);
  std::exponential_distribution<double> exponential;
  Frame frame(number, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance);
  Image& albedo = frame.add(Aov::albedo);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double value = clean(x, y, number);
      for (int c = 0; c < 3; ++c) {
        double sum = 0, squares = 0;
        for (int s = 0; s < 4; ++s) {
          const double radiance = value * exponential(random);
          sum += radiance;
          squares += radiance * radiance;
        }
        beauty.at(x, y, c) = static_cast<float>(sum / 4);
        variance.at(x, y, c) = static_cast<float>((squares - sum * sum / 4) / (3 * 4));
        albedo.at(x, y, c) = static_cast<float>(value / 1.2);
      }
    }
  }
  return frame;
}

double squared_error(const Frame& frame) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double d = frame.image(Aov::beauty).at(x, y, 1) - clean(x, y, frame.number());
      sum += d * d;
    }
  }
  return sum / (kWidth * kHeight);
}

double mean(const Frame& frame) {
  double sum = 0;
  for (std::size_t i = 0; i < frame.image(Aov::beauty).pixel_count(); ++i)
    sum += frame.image(Aov::beauty).data()[4 * i + 1];
  return sum / (kWidth * kHeight);
}

class SequenceFilterTest : public DeviceTest {};

TEST_F(SequenceFilterTest, CalmsAMovingPatternAndKeepsItsEnergy) {
  for (const char* name : {"draft", "balanced", "final"}) {
    SequenceFilter filter(device(), preset(name), kWidth, kHeight, noisy_frame(1).aovs());
    double noisy_error = 0, error = 0, energy = 0, clean_energy = 0;
    for (int number = 1; number <= 12; ++number) {
      const Frame noisy = noisy_frame(number);
      const Denoised denoised = filter.denoise(noisy);
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
  Settings settings = preset("paper");
  settings.mask_kappa = 0.5f;  // the frames are noisier than the paper's
  SequenceFilter filter(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
  double noisy_error = 0, error = 0;
  for (int number = 1; number <= 8; ++number) {
    const Frame noisy = noisy_frame(number);
    const Frame denoised = filter.denoise(noisy).frame;
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
      const Frame of_forward = forward.denoise(noisy_frame(step.frame)).frame;
      if (of_both) {
        EXPECT_TRUE(
            std::ranges::equal(of_both->image(Aov::beauty).data(), of_forward.image(Aov::beauty).data()));
      }
    }
  }
}

/// The balanced preset without what is done to a frame by itself.
Settings unsmoothed() {
  Settings settings = preset("balanced");
  settings.smooth = Smooth::none;
  return settings;
}

TEST_F(SequenceFilterTest, TheFirstFrameAndTheFrameAfterAResetAreTheInput) {
  SequenceFilter filter(device(), unsmoothed(), kWidth, kHeight, noisy_frame(1).aovs(),
                        aov_set({Aov::sample_count, Aov::error_mask, Aov::flow, Aov::bias, Aov::gain}));
  for (const int number : {1, 5}) {
    const Frame noisy = noisy_frame(number);
    const Denoised denoised = filter.denoise(noisy);
    EXPECT_TRUE(
        std::ranges::equal(denoised.frame.image(Aov::beauty).data(), noisy.image(Aov::beauty).data()));
    EXPECT_EQ(denoised.report.mean_sample_count, 1.0);
    EXPECT_EQ(denoised.report.mean_rejected, 1.0);
    for (const auto& [aov, value] : {std::pair{Aov::bias, 0.0f}, {Aov::gain, 1.0f}}) {
      for (const float v : denoised.frame.image(aov).data()) ASSERT_EQ(v, value) << info(aov).name;
    }
    filter.denoise(noisy_frame(number + 1));
    filter.reset();
  }
}

TEST_F(SequenceFilterTest, EqualRunsGiveEqualBytes) {
  std::vector<float> first;
  for (int run = 0; run < 2; ++run) {
    SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
    Denoised denoised;
    for (int number = 1; number <= 3; ++number) denoised = filter.denoise(noisy_frame(number));
    const auto data = denoised.frame.image(Aov::beauty).data();
    if (run == 0) first.assign(data.begin(), data.end());
    EXPECT_TRUE(std::ranges::equal(first, data));
  }
}

TEST_F(SequenceFilterTest, NonFinitePixelsStayWhereTheyAre) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const char* merge : {"merge=variance", "merge=mask"}) {
    Settings settings = preset("balanced");
    set(settings, merge);
    SequenceFilter filter(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
    filter.denoise(noisy_frame(1));
    Frame bad = noisy_frame(2);
    bad.image(Aov::beauty).at(10, 10, 0) = nan;
    bad.image(Aov::beauty).at(50, 40, 2) = -inf;
    bad.image(Aov::beauty).at(0, 0, 1) = inf;
    bad.image(Aov::variance).at(20, 20, 1) = nan;
    bad.image(Aov::albedo).at(30, 30, 0) = nan;
    const Denoised denoised = filter.denoise(bad);
    EXPECT_EQ(denoised.report.non_finite_pixels, 3u) << merge;
    for (int frame = 2; frame <= 4; ++frame) {
      const Denoised result = frame == 2 ? denoised : filter.denoise(noisy_frame(frame));
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          for (int c = 0; c < 4; ++c) {
            const float out = result.frame.image(Aov::beauty).at(x, y, c);
            const float in = bad.image(Aov::beauty).at(x, y, c);
            const bool stays = frame == 2 && !std::isfinite(in);
            ASSERT_EQ(std::isfinite(out), !stays)
                << merge << " frame " << frame << " pixel " << x << "," << y;
          }
          ASSERT_TRUE(std::isfinite(result.frame.image(Aov::variance).at(x, y, 0)));
        }
      }
    }
  }
}

TEST_F(SequenceFilterTest, NoAovsValuesReachFurtherThanTheirPixel) {
  // Every AOV that the filter may use, with numbers that are none in the second frame.
  const auto full_frame = [](int number) {
    Frame frame(number, 24, 20);
    for (const AovInfo& entry : kAovTable) {
      if (!entry.diagnostic) frame.add(entry.aov, 0.5f);
    }
    for (std::size_t i = 0; i < frame.image(Aov::beauty).data().size(); ++i) {
      frame.image(Aov::beauty).data()[i] += 0.01f * static_cast<float>(i % 7);
    }
    return frame;
  };
  for (const char* merge : {"merge=variance", "merge=mask"}) {
    Settings settings = preset("final");
    for (const char* assignment : {merge, "smooth=frames", "additive=0", "motion=guide"}) {
      set(settings, assignment);
    }
    SequenceFilter filter(device(), settings, 24, 20, full_frame(1).aovs());
    for (const AovInfo& entry : kAovTable) {
      if (!contains(wanted_aovs(settings), entry.aov)) continue;
      filter.reset();
      for (int number = 1; number <= 2; ++number) {
        Frame frame = full_frame(number);
        for (int i = 0; number == 2 && i < 6; ++i) {
          frame.image(entry.aov).at(4 * i + 3, 3 * i + 2, 0) =
              std::array{std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()}[static_cast<std::size_t>(i % 3)];
        }
        const Denoised denoised = filter.denoise(frame);
        EXPECT_EQ(denoised.report.non_finite_pixels, 0u);
        for (const float v : denoised.frame.image(Aov::beauty).data()) {
          ASSERT_TRUE(v > 0.45f && v < 0.65f) << merge << ", " << entry.name << ": " << v;
        }
        for (const float v : denoised.frame.image(Aov::variance).data()) {
          ASSERT_TRUE(std::isfinite(v) && v >= 0.0f) << merge << ", " << entry.name << ": " << v;
        }
      }
    }
  }
}

TEST_F(SequenceFilterTest, BlackFramesStayBlackAndHoldNothingBack) {
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
  Frame black(1, kWidth, kHeight);
  for (const Aov aov : {Aov::beauty, Aov::variance, Aov::albedo}) black.add(aov);
  for (int number = 1; number <= 3; ++number) {
    const Denoised denoised = filter.denoise(black);
    for (const Aov aov : {Aov::beauty, Aov::variance}) {
      for (const float v : denoised.frame.image(aov).data()) ASSERT_EQ(v, 0.0f) << info(aov).name;
    }
  }
  const Frame lit = noisy_frame(4);
  EXPECT_NEAR(mean(filter.denoise(lit).frame) / mean(lit), 1.0, 0.01);
}

TEST_F(SequenceFilterTest, NothingDriftsOverThousandsOfFrames) {
  // A history that is never begun anew: what floats round away in each frame would add up.
  Settings settings = preset("draft");
  settings.smooth = Smooth::none;
  settings.patch_radius = 3;
  settings.pyramid_levels = 1;
  settings.motion = MotionUse::override_offset;
  constexpr int size = 8;
  constexpr int first_counted = 1000;
  constexpr int frames = 10000;
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
    denoised = filter.denoise(frame);
    if (number < first_counted) continue;
    of_inputs += mean(frame);
    of_outputs += mean(denoised.frame);
  }
  EXPECT_GT(denoised.report.mean_sample_count, 32.0);
  EXPECT_NEAR(of_outputs / of_inputs, 1.0, 3e-5);
}

TEST_F(SequenceFilterTest, ExtremesStayFinite) {
  // One enormous pixel in an ordinary frame, and frames that are enormous or tiny as a whole.
  const auto scaled = [](int number, float factor) {
    Frame frame = noisy_frame(number);
    for (float& v : frame.image(Aov::beauty).data()) v *= factor;
    for (float& v : frame.image(Aov::variance).data()) v = std::min(v * factor * factor, 3e38f);
    return frame;
  };
  for (const float factor : {1.0f, 1e-30f, 1e30f}) {
    for (const bool with_variance : {true, false}) {
      SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight,
                            with_variance ? noisy_frame(1).aovs() : aov_set({Aov::albedo}));
      for (int number = 1; number <= 4; ++number) {
        Frame frame = scaled(number, factor);
        if (number == 2) std::ranges::fill(frame.image(Aov::beauty).pixel(40, 30), 1e30f);
        const Denoised denoised = filter.denoise(frame);
        EXPECT_EQ(denoised.report.non_finite_pixels, 0u);
        for (const Aov aov : {Aov::beauty, Aov::variance}) {
          for (const float v : denoised.frame.image(aov).data()) {
            ASSERT_TRUE(std::isfinite(v))
                << "factor " << factor << " frame " << number << " " << info(aov).name;
          }
        }
      }
    }
  }
}

TEST_F(SequenceFilterTest, FramesWithoutVarianceOrGuidesAreDenoisedToo) {
  Frame bare = noisy_frame(1);
  bare.remove(Aov::variance);
  bare.remove(Aov::albedo);
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, bare.aovs());
  double noisy_error = 0, error = 0;
  for (int number = 1; number <= 8; ++number) {
    Frame frame = noisy_frame(number);
    frame.remove(Aov::variance);
    frame.remove(Aov::albedo);
    const Denoised denoised = filter.denoise(frame);
    if (number < 6) continue;
    noisy_error += squared_error(frame);
    error += squared_error(denoised.frame);
  }
  EXPECT_LT(error, noisy_error / 2);
}

TEST_F(SequenceFilterTest, HalfBuffersServeInPlaceOfVariance) {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0f, 0.1f);
  SequenceFilter filter(device(), unsmoothed(), kWidth, kHeight, aov_set({Aov::half_a, Aov::half_b}));
  double variance = 0;
  Frame frame(1, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& a = frame.add(Aov::half_a);
  Image& b = frame.add(Aov::half_b);
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    a.data()[i] = 1.0f + noise(random);
    b.data()[i] = 1.0f + noise(random);
    beauty.data()[i / 3 * 4 + i % 3] = 0.5f * (a.data()[i] + b.data()[i]);
  }
  const Denoised denoised = filter.denoise(frame);
  for (const float v : denoised.frame.image(Aov::variance).data()) variance += v / (3.0 * kWidth * kHeight);
  // Two halves with a standard deviation of 0.1 each: their mean has a variance of 0.005.
  EXPECT_NEAR(variance, 0.005, 0.0005);
}

TEST_F(SequenceFilterTest, FramesThatDifferAreRefused) {
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
  Frame other(7, kWidth / 2, kHeight);
  other.add(Aov::beauty);
  const auto message = [&](const Frame& frame) -> std::string {
    try {
      filter.denoise(frame);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(other), "frame 7: size 48x64: expected 96x64 as the frames before it");
  Frame lacking = noisy_frame(8);
  lacking.remove(Aov::albedo);
  EXPECT_EQ(message(lacking), "frame 8: no layer 'albedo', which the frames before it have");
}

TEST_F(SequenceFilterTest, SizesFromOnePixelUp) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 37}, {53, 1}, {3, 2}, {17, 16}}) {
    SequenceFilter filter(device(), preset("balanced"), width, height, {});
    for (int number = 1; number <= 2; ++number) {
      Frame frame(number, width, height);
      frame.add(Aov::beauty, 0.5f);
      const Denoised denoised = filter.denoise(frame);
      for (const float v : denoised.frame.image(Aov::beauty).data())
        ASSERT_EQ(v, 0.5f) << width << "x" << height;
    }
  }
}

}  // namespace
}  // namespace becalm::filter
