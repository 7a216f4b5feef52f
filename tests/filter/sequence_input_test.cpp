// Which values frames may hold, and which AOVs they may lack.
#include "filter/merge/additive.h"
#include "filter/sequence/sequence_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "frame/error.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/moving_pattern.h"

namespace becalm::filter::sequence_input_test {
namespace {

using namespace moving_pattern;

class SequenceInputTest : public DeviceTest {};

TEST_F(SequenceInputTest, NonFinitePixelsStayWhereTheyAre) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const char* merge : {"merge=variance", "merge=mask"}) {
    Settings settings = preset("balanced");
    set(settings, merge);
    SequenceFilter filter(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
    denoise_frame(filter, noisy_frame(1));
    Frame bad = noisy_frame(2);
    bad.image(Aov::beauty).at(10, 10, 0) = nan;
    bad.image(Aov::beauty).at(50, 40, 2) = -inf;
    bad.image(Aov::beauty).at(0, 0, 1) = inf;
    bad.image(Aov::variance).at(20, 20, 1) = nan;
    bad.image(Aov::albedo).at(30, 30, 0) = nan;
    const Denoised denoised = denoise_frame(filter, bad);
    EXPECT_EQ(denoised.report.non_finite_pixels, 3u) << merge;
    for (int frame = 2; frame <= 4; ++frame) {
      const Denoised result = frame == 2 ? denoised : denoise_frame(filter, noisy_frame(frame));
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

TEST_F(SequenceInputTest, NegativeVariancesAreReplacedAsNaNIs) {
  const auto denoised = [](float variance) {
    SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
    Frame frame = noisy_frame(1);
    for (int i = 0; i < 5; ++i) {
      std::ranges::fill(frame.image(Aov::variance).pixel(10 + 15 * i, 20 + i), variance);
    }
    return denoise_frame(filter, frame);
  };
  const Denoised negative = denoised(-0.01f);
  EXPECT_EQ(negative.report.replaced_variances, 5u);
  const Denoised nan = denoised(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(
      std::ranges::equal(negative.frame.image(Aov::beauty).data(), nan.frame.image(Aov::beauty).data()));
}

TEST_F(SequenceInputTest, NoAovsValuesReachFurtherThanTheirPixel) {
  // Every AOV that the filter may use, with non-finite values in the second frame.
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
    for (const char* assignment : {merge, "smooth=frames", "motion=guide"}) {
      set(settings, assignment);
    }
    SequenceFilter filter(device(), settings, 24, 20, full_frame(1).aovs() & ~additive_aovs());
    for (const AovInfo& entry : kAovTable) {
      if (!contains(wanted_aovs(settings), entry.aov)) continue;
      for (int number = 1; number <= 2; ++number) {
        Frame frame = full_frame(number);
        for (int i = 0; number == 2 && i < 6; ++i) {
          frame.image(entry.aov).at(4 * i + 3, 3 * i + 2, 0) =
              std::array{std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()}[static_cast<std::size_t>(i % 3)];
        }
        const Denoised denoised = denoise_frame(filter, frame, /*new_history=*/number == 1);
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

TEST_F(SequenceInputTest, SoftEdgesOfFewSamplesKeepTheirLightAndAlpha) {
  constexpr int width = 96, height = 64, samples = 4;
  constexpr float light = 0.5f;
  const auto coverage = [](int x, int y) {
    return std::clamp((32.0f - std::hypot(x - 47.5f, y - 31.5f)) / 20.0f, 0.0f, 1.0f);
  };
  SequenceFilter filter(device(), preset("draft"), width, height, AovSet(), {.alpha = Alpha::denoise});
  double covered = 0.0, shown = 0.0, alpha = 0.0;
  for (int number = 1; number <= 4; ++number) {
    std::mt19937 random(static_cast<unsigned>(number));
    std::normal_distribution<float> noise(1.0f, 0.2f);
    Frame frame(number, width, height);
    Image& beauty = frame.add(Aov::beauty);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        std::binomial_distribution<int> hits(samples, coverage(x, y));
        beauty.at(x, y, 3) = static_cast<float>(hits(random)) / samples;
        for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = beauty.at(x, y, 3) * light * noise(random);
      }
    }
    const Image denoised = denoise_frame(filter, frame).frame.image(Aov::beauty);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (coverage(x, y) > 0.3f) continue;
        covered += coverage(x, y);
        shown += denoised.at(x, y, 1);
        alpha += denoised.at(x, y, 3);
      }
    }
  }
  EXPECT_NEAR(shown / (light * covered), 1.0, 0.1);
  EXPECT_NEAR(alpha / covered, 1.0, 0.1);
}

TEST_F(SequenceInputTest, BlackFramesStayBlackAndHoldNothingBack) {
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
  Frame black(1, kWidth, kHeight);
  for (const Aov aov : {Aov::beauty, Aov::variance, Aov::albedo}) black.add(aov);
  for (int number = 1; number <= 3; ++number) {
    const Denoised denoised = denoise_frame(filter, black);
    for (const Aov aov : {Aov::beauty, Aov::variance}) {
      for (const float v : denoised.frame.image(aov).data()) ASSERT_EQ(v, 0.0f) << info(aov).name;
    }
  }
  const Frame lit = noisy_frame(4);
  EXPECT_NEAR(mean(denoise_frame(filter, lit).frame) / mean(lit), 1.0, 0.01);
}

TEST_F(SequenceInputTest, ExtremesStayFinite) {
  // One huge value in an ordinary frame, and whole frames of huge or tiny values.
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
        const Denoised denoised = denoise_frame(filter, frame);
        EXPECT_EQ(denoised.report.non_finite_pixels, 0u);
        EXPECT_EQ(denoised.report.replaced_variances, 0u) << factor;
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

TEST_F(SequenceInputTest, FramesWithoutVarianceOrGuidesAreDenoisedToo) {
  Frame bare = noisy_frame(1);
  bare.remove(Aov::variance);
  bare.remove(Aov::albedo);
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, bare.aovs());
  double noisy_error = 0, error = 0;
  for (int number = 1; number <= 8; ++number) {
    Frame frame = noisy_frame(number);
    frame.remove(Aov::variance);
    frame.remove(Aov::albedo);
    const Denoised denoised = denoise_frame(filter, frame);
    if (number < 6) continue;
    noisy_error += squared_error(frame);
    error += squared_error(denoised.frame);
  }
  EXPECT_LT(error, noisy_error / 2);
}

TEST_F(SequenceInputTest, HalfBuffersServeInPlaceOfVariance) {
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
  const Denoised denoised = denoise_frame(filter, frame);
  for (const float v : denoised.frame.image(Aov::variance).data()) variance += v / (3.0 * kWidth * kHeight);
  // Two halves with a standard deviation of 0.1 each: their mean has a variance of 0.005.
  EXPECT_NEAR(variance, 0.005, 0.0005);
}

TEST_F(SequenceInputTest, FramesThatDifferAreRefused) {
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, noisy_frame(1).aovs());
  Frame other(7, kWidth / 2, kHeight);
  other.add(Aov::beauty);
  const auto message = [&](const Frame& frame) -> std::string {
    try {
      denoise_frame(filter, frame);
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

TEST_F(SequenceInputTest, SizesFromOnePixelUp) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 37}, {53, 1}, {3, 2}, {17, 16}}) {
    SequenceFilter filter(device(), preset("balanced"), width, height, {});
    for (int number = 1; number <= 2; ++number) {
      Frame frame(number, width, height);
      frame.add(Aov::beauty, 0.5f);
      const Denoised denoised = denoise_frame(filter, frame);
      for (const float v : denoised.frame.image(Aov::beauty).data())
        ASSERT_EQ(v, 0.5f) << width << "x" << height;
    }
  }
}

}  // namespace
}  // namespace becalm::filter::sequence_input_test
