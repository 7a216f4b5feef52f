// The history read without its albedo.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "filter/host_images.h"
#include "filter/order.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/guided_frame.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr float kShift = 0.5f;  // pixels a frame, along both axes

/// A frame of surfaces that move by half a pixel a frame, as its motion says: `albedo_at(u, v)` and
/// `radiance_at(u, v)`, the same in all channels.
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

/// The merge alone, along the known motion.
Settings merge_alone(const char* assignment) {
  Settings settings = preset("draft");
  set(settings, "motion=override");
  set(settings, "correct_levels=0");
  set(settings, assignment);
  return settings;
}

/// Mean squared difference of neighbours away from the borders, at which surfaces come into view.
double contrast(const Image& image) {
  double sum = 0.0;
  for (int y = 8; y < kHeight - 8; ++y) {
    for (int x = 8; x < kWidth - 8; ++x) {
      const double d = image.at(x + 1, y, 1) - image.at(x, y, 1);
      sum += d * d;
    }
  }
  return sum;
}

class DemodulateHistoryTest : public DeviceTest {};

TEST_F(DemodulateHistoryTest, TextureStaysAsSharpAsTheFramesOwn) {
  constexpr float irradiance = 2.0f;
  const auto albedo_at = [](float u, float v) {
    return static_cast<float>(0.05 + 0.9 * pattern(2.5 * u, 2.5 * v, 9));
  };
  const auto textured = [&](int number) {
    return moving_frame(number, albedo_at, [&](float u, float v) { return irradiance * albedo_at(u, v); });
  };
  constexpr int last = 8;
  const auto contrast_with = [&](const char* assignment) {
    SequenceFilter filter(device(), merge_alone(assignment), kWidth, kHeight, textured(1).aovs());
    Denoised denoised;
    for (int number = 1; number <= last; ++number) denoised = filter.denoise(textured(number));
    EXPECT_GT(denoised.report.mean_sample_count, 4.0);
    return contrast(denoised.frame.image(Aov::beauty)) / contrast(textured(last).image(Aov::beauty));
  };
  EXPECT_NEAR(contrast_with("demodulate_history=1"), 1.0, 1e-3);
  EXPECT_LT(contrast_with("demodulate_history=0"), 0.8);
}

TEST_F(DemodulateHistoryTest, EmittersAndBlackSurfacesKeepTheirBrightness) {
  // Stripes of emitters that are called white or black, between walls that are dark, grey, black or white.
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
    set(settings, "demodulate_history=1");
    set(settings, "directions=forward");
    SequenceFilter filter(device(), settings, kWidth, kHeight, striped(1).aovs());
    for (int number = 1; number <= 5; ++number) {
      const Denoised denoised = filter.denoise(striped(number));
      for (const float v : denoised.frame.image(Aov::beauty).data()) {
        // What the correction of block means adds to the brightest is its own.
        ASSERT_TRUE(v >= 0.0f && v < 125.0f) << name << ", frame " << number << ": " << v;
      }
      for (const float v : denoised.frame.image(Aov::variance).data()) {
        ASSERT_TRUE(std::isfinite(v) && v >= 0.0f) << name << ", frame " << number << ": " << v;
      }
    }
  }
}

TEST_F(DemodulateHistoryTest, AlbedoThatIsNotFiniteDarkensAndBrightensNothing) {
  constexpr float albedo = 0.1f;
  constexpr float radiance = 0.2f;
  const auto even = [&](int number) {
    return moving_frame(
        number, [&](float, float) { return albedo; }, [&](float, float) { return radiance; });
  };
  SequenceFilter filter(device(), merge_alone("demodulate_history=1"), kWidth, kHeight, even(1).aovs());
  for (int number = 1; number <= 5; ++number) {
    Frame frame = even(number);
    if (number == 3) {
      frame.image(Aov::albedo).at(20, 20, 1) = std::numeric_limits<float>::quiet_NaN();
      frame.image(Aov::albedo).at(40, 30, 0) = std::numeric_limits<float>::infinity();
    }
    const Image beauty = filter.denoise(frame).frame.image(Aov::beauty);
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
}  // namespace becalm::filter
