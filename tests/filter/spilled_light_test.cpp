// Light that smoothing spreads beyond a matte returns to it.
#include "filter/sequence/spilled_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "filter/luminance.h"
#include "filter/sequence/sequence_filter.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"

namespace becalm::filter::spilled_light_test {
namespace {

/// A grey pixel.
struct Pixel {
  float light;
  float alpha;
};

Image row(const std::vector<Pixel>& pixels) {
  Image image(static_cast<int>(pixels.size()), 1, 4);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    std::fill_n(image.data().begin() + 4 * i, 3, pixels[i].light);
    image.data()[4 * i + 3] = pixels[i].alpha;
  }
  return image;
}

TEST(SpilledLight, GoesToPixelsWithAlpha) {
  const Image beauty = row({{1, 1}, {0.5f, 0.5f}, {0, 0}, {1, 0}});
  const Image denoised = row({{0.8f, 1}, {0.4f, 0.5f}, {0.1f, 0.1f}, {0.3f, 0}});
  std::vector<float> factors = spilled_light(beauty, std::vector<std::uint8_t>{0, 0, 1, 0}, denoised);
  // 0.1 goes to pixels of 1.2.
  ASSERT_EQ(factors.size(), 4u);
  EXPECT_NEAR(factors[0], 1.0f + 0.1f / 1.2f, 1e-6);
  EXPECT_NEAR(factors[1], 1.0f + 0.1f / 1.2f, 1e-6);
  EXPECT_EQ(factors[2], 1.0f);
  EXPECT_EQ(factors[3], 1.0f) << "light without alpha";
  EXPECT_TRUE(spilled_light(beauty, std::vector<std::uint8_t>(4), denoised).empty());
}

TEST(SpilledLight, NoPixelBecomesBrighterThanThoseAroundItWere) {
  const std::vector<std::uint8_t> empty{1, 0, 0, 1};
  const Image denoised = row({{5, 0.5f}, {1, 0.5f}, {1, 0.5f}, {5, 0.5f}});
  const std::vector<float> factors = spilled_light(row({{0, 0}, {2, 1}, {3, 1}, {0, 0}}), empty, denoised);
  ASSERT_EQ(factors.size(), 4u);
  EXPECT_EQ(factors[1], 3.0f);
  EXPECT_EQ(factors[2], 3.0f);
}

TEST(SpilledLight, GoesNoFartherThanThreePixels) {
  const Image beauty = row({{1, 1}, {0, 0}, {0, 0}, {0, 0}, {0, 0}});
  const std::vector<std::uint8_t> empty{0, 1, 1, 1, 1};
  EXPECT_TRUE(spilled_light(beauty, empty, row({{0.9f, 0.9f}, {}, {}, {}, {0.1f, 0.1f}})).empty());
  EXPECT_FALSE(spilled_light(beauty, empty, row({{0.9f, 0.9f}, {}, {}, {0.1f, 0.1f}, {}})).empty());
}

TEST(SpilledLight, NothingIsLostOrMadeAtAnyScale) {
  constexpr int size = 40;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0.1f, 1.0f);
  for (const float scale : {1e-30f, 1.0f, 1e30f}) {
    Image beauty(size, size, 4), denoised(size, size, 4);
    std::vector<std::uint8_t> empty(size * size);
    for (std::size_t i = 0; i < empty.size(); ++i) {
      empty[i] = random() % 3 == 0;
      const float kept = empty[i] ? 0.05f : 0.5f;
      beauty.data()[4 * i + 3] = empty[i] ? 0.0f : 1.0f;
      for (int c = 0; c < 3; ++c) beauty.data()[4 * i + c] = empty[i] ? 0.0f : 2.0f * scale;
      denoised.data()[4 * i + 3] = kept * uniform(random);
      for (int c = 0; c < 3; ++c) denoised.data()[4 * i + c] = kept * uniform(random) * scale;
    }
    const std::vector<float> factors = spilled_light(beauty, empty, denoised);
    ASSERT_EQ(factors.size(), empty.size());
    double before = 0.0, after = 0.0;
    for (std::size_t i = 0; i < empty.size(); ++i) {
      const double light =
          luminance(std::span<const float>(denoised.data()).subspan(4 * i, 3)) / double{scale};
      before += light;
      if (!empty[i]) after += factors[i] * light;
      EXPECT_GE(factors[i], 1.0f);
    }
    EXPECT_NEAR(after, before, 1e-5 * before) << scale;
  }
  const float most = std::numeric_limits<float>::max();
  const std::vector<float> factors =
      spilled_light(row({{most, 1}, {0, 0}}), std::vector<std::uint8_t>{0, 1}, row({{1e-30f, 1}, {most, 1}}));
  ASSERT_EQ(factors.size(), 2u);
  EXPECT_TRUE(std::isfinite(factors[0] * factors[0]));
}

constexpr int kWidth = 96;
constexpr int kHeight = 64;

/// A disc out of focus, of 4 samples a pixel, over nothing. Half of the light is direct.
Frame blurred_disc() {
  std::mt19937 random(7);
  Frame frame(1, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float away = std::hypot(static_cast<float>(x) - 47.5f, static_cast<float>(y) - 31.5f);
      const float covered = std::clamp((32.0f - away) / 24.0f, 0.0f, 1.0f);
      beauty.at(x, y, 3) = static_cast<float>(std::binomial_distribution<int>(4, covered)(random)) / 4.0f;
    }
  }
  std::gamma_distribution<float> noise(3.0f, 1.0f / 3.0f);
  Image& direct = frame.add(Aov::direct);
  Image& indirect = frame.add(Aov::indirect);
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    const float light = 0.6f * beauty.data()[4 * i + 3] * noise(random);
    for (std::size_t c = 0; c < 3; ++c) {
      beauty.data()[4 * i + c] = light;
      direct.data()[3 * i + c] = indirect.data()[3 * i + c] = 0.5f * light;
    }
  }
  return frame;
}

double mean(const Image& beauty) {
  double sum = 0.0;
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) sum += beauty.data()[4 * i + 1];
  return sum / static_cast<double>(beauty.pixel_count());
}

class SpilledLightTest : public DeviceTest {};

TEST_F(SpilledLightTest, BlurredEdgesKeepTheirLightAndTheirGapsAreBlack) {
  const Frame noisy = blurred_disc();
  for (const char* name : {"draft", "final"}) {
    Settings settings = preset(name);
    settings.directions = Directions::forward;
    SequenceOptions options;
    options.diagnostics.set(static_cast<std::size_t>(Aov::remaining_variance));
    SequenceFilter filter(device(), settings, kWidth, kHeight, noisy.aovs(), options);
    const Frame denoised = denoise_frame(filter, noisy).frame;
    const Image& before = noisy.image(Aov::beauty);
    const Image& after = denoised.image(Aov::beauty);
    EXPECT_NEAR(mean(after) / mean(before), 1.0, 0.02) << name;
    for (std::size_t i = 0; i < after.pixel_count(); ++i) {
      EXPECT_EQ(after.data()[4 * i + 3], before.data()[4 * i + 3]);
      if (before.data()[4 * i + 3] == 0.0f) {
        EXPECT_EQ(after.data()[4 * i], 0.0f);
      }
      EXPECT_EQ(denoised.image(Aov::remaining_variance).data()[i],
                denoised.image(Aov::variance).data()[3 * i]);
      const float whole = after.data()[4 * i];
      const float parts =
          denoised.image(Aov::direct).data()[3 * i] + denoised.image(Aov::indirect).data()[3 * i];
      EXPECT_NEAR(parts, whole, 2e-5f) << name << ", pixel " << i;
    }
  }
}

TEST_F(SpilledLightTest, TheVarianceGrowsByTheSquareOfTheLight) {
  const Frame with_matte = blurred_disc();
  Frame opaque = with_matte;
  Image& beauty = opaque.image(Aov::beauty);
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) beauty.data()[4 * i + 3] = 1.0f;
  Settings settings = preset("draft");
  const auto denoised = [&](const Frame& frame) {
    SequenceFilter filter(device(), settings, kWidth, kHeight, frame.aovs());
    return denoise_frame(filter, frame).frame;
  };
  const Frame grown = denoised(with_matte), before = denoised(opaque);
  int larger = 0;
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    if (with_matte.image(Aov::beauty).data()[4 * i + 3] == 0.0f) continue;
    const double light = grown.image(Aov::beauty).data()[4 * i + 1];
    const double factor = light / before.image(Aov::beauty).data()[4 * i + 1];
    if (!(factor > 1.05)) continue;
    ++larger;
    const double of_variance =
        grown.image(Aov::variance).data()[3 * i] / before.image(Aov::variance).data()[3 * i];
    EXPECT_NEAR(of_variance / (factor * factor), 1.0, 1e-3) << i;
  }
  EXPECT_GT(larger, 20);
}

}  // namespace
}  // namespace becalm::filter::spilled_light_test
