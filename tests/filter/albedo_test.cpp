// Sequences whose albedo is noisy, black, white or not finite.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "filter/input/host_images.h"
#include "filter/sequence/sequence_filter.h"
#include "filter/smooth/albedo_smoother.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/guided_frame.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::albedo_test {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr float kShift = 0.5f;  // pixels per frame, along both axes

/// A frame of surfaces that move by half a pixel per frame, with their motion AOV. Albedo is `albedo_at(u,
/// v)` and radiance `radiance_at(u, v)` in all channels.
template <class AlbedoAt, class RadianceAt>
Frame moving_frame(int number, const AlbedoAt& albedo_at, const RadianceAt& radiance_at) {
  const auto u_of = [&](int x) { return x + kShift * static_cast<float>(number); };
  Frame frame = guided_frame(number, kWidth, kHeight, [&](int x, int y) {
    const float albedo = albedo_at(u_of(x), u_of(y));
    return SurfacePixel{.albedo = {albedo, albedo, albedo}, .normal_z = 1.0f, .depth = 4.0f};
  });
  std::ranges::fill(frame.add(Aov::motion).data(), kShift);
  std::ranges::fill(frame.image(Aov::variance).data(), 0.01f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      std::ranges::fill(frame.image(Aov::beauty).pixel(x, y).first(3), radiance_at(u_of(x), u_of(y)));
    }
  }
  return frame;
}

/// Mean squared difference of a denoised frame from `truth_at(x, y)`, excluding the borders, where surfaces
/// come into view.
template <class TruthAt>
double squared_error(const Frame& frame, const TruthAt& truth_at) {
  constexpr int margin = 12;
  double sum = 0.0;
  for (int y = margin; y < kHeight - margin; ++y) {
    for (int x = margin; x < kWidth - margin; ++x) {
      const double d = frame.image(Aov::beauty).at(x, y, 1) - truth_at(x, y);
      sum += d * d;
    }
  }
  return sum / ((kWidth - 2 * margin) * (kHeight - 2 * margin));
}

constexpr float kIrradiance = 2.0f;
constexpr int kFrames = 8;

class AlbedoTest : public DeviceTest {};

TEST_F(AlbedoTest, NoiseOfTheAlbedoMakesNothingWorse) {
  // Stripes with soft edges, as out of focus, of four samples; albedo and radiance have the same noise.
  const auto covered = [](float u) {
    return std::clamp(std::abs(std::fmod(u, 16.0f) - 8.0f) - 3.5f, 0.0f, 1.0f);
  };
  const auto albedo_of = [](float share) { return 0.1f + 0.8f * share; };
  const auto noisy_frame = [&](int number) {
    std::mt19937 random(number);
    Frame frame = moving_frame(
        number, [&](float u, float) { return covered(u); }, [](float, float) { return 0.0f; });
    for (std::size_t i = 0; i < frame.image(Aov::albedo).pixel_count(); ++i) {
      constexpr int samples = 4;
      std::binomial_distribution<int> hits(samples, frame.image(Aov::albedo).data()[3 * i]);
      const float albedo = albedo_of(static_cast<float>(hits(random)) / samples);
      std::ranges::fill(frame.image(Aov::albedo).data().subspan(3 * i, 3), albedo);
      std::ranges::fill(frame.image(Aov::beauty).data().subspan(4 * i, 3), kIrradiance * albedo);
    }
    return frame;
  };
  const auto truth_at = [&](int x, int) {
    return kIrradiance * albedo_of(covered(static_cast<float>(x) + kShift * kFrames));
  };
  Settings settings = preset("balanced");
  settings.directions = Directions::forward;
  SequenceFilter filter(device(), settings, kWidth, kHeight, noisy_frame(1).aovs());
  Denoised denoised;
  for (int number = 1; number <= kFrames; ++number) denoised = denoise_frame(filter, noisy_frame(number));
  EXPECT_LT(squared_error(denoised.frame, truth_at), squared_error(noisy_frame(kFrames), truth_at));
}

/// What AlbedoSmoother makes of an albedo without other features.
Image smoothed(gpu::Device& device, Image albedo) {
  Frame frame(1, albedo.width(), albedo.height());
  frame.image(Aov::albedo) = std::move(albedo);
  AovSet used;
  used.set(static_cast<std::size_t>(Aov::albedo));
  AlbedoSmoother smoother(device,
                          {.settings = preset("balanced"),
                           .full = {frame.width(), frame.height()},
                           .used = used,
                           .diagnostics = {},
                           .guides = {}},
                          std::numeric_limits<std::uint64_t>::max());
  FrameReport report;
  return smoother.smooth({.frame = frame, .finite = {}, .exposure = 7.0f}, report);
}

double mean_square_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) sum += std::pow(a.data()[i] - b.data()[i], 2.0);
  return sum / static_cast<double>(a.data().size());
}

TEST_F(AlbedoTest, NoiseOfTheAlbedoItselfIsSmoothed) {
  // Coats that mirror a part of the samples; the albedo is the mean of four samples.
  Image clean(kWidth, kHeight, 3);
  Image noisy = clean;
  std::mt19937 random(3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double mirrored = x < kWidth / 2 ? 0.2 : 0.5;
      const int hits = std::binomial_distribution<int>(4, mirrored)(random);
      std::ranges::fill(clean.pixel(x, y), static_cast<float>(0.3 + 0.5 * mirrored));
      std::ranges::fill(noisy.pixel(x, y), 0.3f + 0.125f * static_cast<float>(hits));
    }
  }
  EXPECT_LT(mean_square_difference(smoothed(device(), noisy), clean),
            0.3 * mean_square_difference(noisy, clean));
}

TEST_F(AlbedoTest, FineStripesOfClothStay) {
  constexpr double amplitude = 0.25;
  for (const double period_px : {3.0, 4.5, 7.0}) {
    Image stripes(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double folded = 0.8 * x + 0.6 * y + 1.5 * std::sin(0.12 * x);
        const double wave = amplitude * std::sin(2.0 * std::numbers::pi * folded / period_px);
        for (int c = 0; c < 3; ++c) stripes.at(x, y, c) = static_cast<float>(0.5 + (c == 1 ? -wave : wave));
      }
    }
    EXPECT_LT(mean_square_difference(smoothed(device(), stripes), stripes), 0.1 * amplitude * amplitude / 2)
        << period_px;
  }
}

TEST_F(AlbedoTest, ACleanTextureStays) {
  Image texture(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) texture.at(x, y, c) = (x / 4 + y / 3 + c) % 2 ? 0.8f : 0.2f;
    }
  }
  EXPECT_LT(mean_square_difference(smoothed(device(), texture), texture), 0.02 * 0.09);  // of its variance
}

TEST_F(AlbedoTest, TheSmoothedAlbedoIsFiniteAndInRange) {
  Image albedo(33, 20, 3, 0.5f);
  albedo.at(4, 5, 0) = std::numeric_limits<float>::quiet_NaN();
  albedo.at(9, 5, 2) = std::numeric_limits<float>::infinity();
  albedo.at(20, 10, 1) = 1e30f;
  albedo.at(21, 11, 1) = -1e30f;
  const Image smooth = smoothed(device(), albedo);
  for (const float value : smooth.data()) {
    EXPECT_GE(value, 0.0f);
    EXPECT_LE(value, 1.0f + 1e-6f);
  }
  const Image even = smoothed(device(), Image(17, 3, 3, 0.5f));
  for (const float value : even.data()) EXPECT_NEAR(value, 0.5f, 1e-5f);
}

TEST_F(AlbedoTest, EmittersAndBlackSurfacesKeepTheirBrightness) {
  // Stripes of emitters with an albedo of 1 or 0, between walls that are dark, grey, black or white.
  struct Stripe {
    float albedo;
    float radiance;
  };
  constexpr std::array<Stripe, 6> stripes{
      {{1, 100}, {0.02f, 0.01f}, {0, 100}, {0.5f, 0.4f}, {0, 0}, {1, 0.8f}}};
  const auto stripe_at = [&](float u) { return stripes[static_cast<std::size_t>(u / 8) % stripes.size()]; };
  const auto striped = [&](int number) {
    return moving_frame(
        number, [&](float u, float) { return stripe_at(u).albedo; },
        [&](float u, float) { return stripe_at(u).radiance; });
  };
  for (const char* name : {"draft", "balanced", "final"}) {
    Settings settings = preset(name);
    set(settings, "directions=forward");
    SequenceFilter filter(device(), settings, kWidth, kHeight, striped(1).aovs());
    for (int number = 1; number <= 5; ++number) {
      const Denoised denoised = denoise_frame(filter, striped(number));
      const Image& beauty = denoised.frame.image(Aov::beauty);
      for (const float v : beauty.data()) {
        // The albedo's windows may include neighbours.
        ASSERT_TRUE(v >= 0.0f && v < 150.0f) << name << ", frame " << number << ": " << v;
      }
      for (int y = 0; y < kHeight; y += 5) {
        for (int x = 12; x < kWidth - 12; ++x) {
          const float u = static_cast<float>(x) + kShift * static_cast<float>(number);
          const float in_stripe = std::fmod(u, 8.0f);
          const float radiance = stripe_at(u).radiance;
          // Its middle; the dark wall lies beside the emitter, which shines into it.
          if (in_stripe < 3.0f || in_stripe > 4.0f || radiance == 0.01f) continue;
          ASSERT_NEAR(beauty.at(x, y, 1), radiance, 0.4f * radiance + 0.01f) << name << ", frame " << number;
        }
      }
      for (const float v : denoised.frame.image(Aov::variance).data()) {
        ASSERT_TRUE(std::isfinite(v) && v >= 0.0f) << name << ", frame " << number << ": " << v;
      }
    }
  }
}

TEST_F(AlbedoTest, AlbedoThatIsNotFiniteDarkensAndBrightensNothing) {
  constexpr float albedo = 0.1f;
  constexpr float radiance = 0.2f;
  const auto even = [&](int number) {
    return moving_frame(
        number, [&](float, float) { return albedo; }, [&](float, float) { return radiance; });
  };
  SequenceFilter filter(device(), preset("draft"), kWidth, kHeight, even(1).aovs());
  for (int number = 1; number <= 5; ++number) {
    Frame frame = even(number);
    if (number == 3) {
      frame.image(Aov::albedo).at(20, 20, 1) = std::numeric_limits<float>::quiet_NaN();
      frame.image(Aov::albedo).at(40, 30, 0) = std::numeric_limits<float>::infinity();
    }
    const Image beauty = denoise_frame(filter, frame).frame.image(Aov::beauty);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(beauty.data()[4 * i + c], radiance, 1e-5f) << "frame " << number;
    }
  }
}

TEST(PackAlbedo, FillsWhatIsNotFiniteFromItsNeighboursAndClamps) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Image albedo(4, 1, 3);
  std::ranges::copy(std::array{0.2f, 0.4f, 0.6f, nan, 0.5f, 0.5f, 0.4f, 1.5f, -1.0f, 0.5f, 0.5f, 0.5f},
                    albedo.data().begin());
  std::vector<float> packed(4 * 3);
  pack_albedo(albedo, {1, 0, 3, 1}, packed);
  const std::array expected{0.3f, 0.95f, 0.0f, 0.0f, 0.4f, 1.0f, 0.0f, 0.0f, 0.5f, 0.5f, 0.5f, 0.0f};
  for (std::size_t i = 0; i < packed.size(); ++i) EXPECT_FLOAT_EQ(packed[i], expected[i]) << i;

  std::ranges::fill(albedo.data(), nan);
  pack_albedo(albedo, {1, 0, 3, 1}, packed);
  for (std::size_t i = 0; i < packed.size(); ++i) EXPECT_EQ(packed[i], i % 4 == 3 ? 0.0f : 1.0f) << i;
}

}  // namespace
}  // namespace becalm::filter::albedo_test
