// Temporal antialiasing of light that changes: results have the energy of their frames.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "filter/antialias/antialias_filter.h"
#include "tests/filter/device_fixture.h"

namespace becalm::filter::antialias_light_test {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;
constexpr int kFrames = 8;
using Light = std::array<double, kFrames>;

/// Stripes of a contrast of 10 whose edges every frame samples at other places; `light` scales them from the
/// column `left` on.
Frame stripes(int number, double light, int left) {
  Frame frame(number, kWidth, kHeight);
  const Imath::V2f at{0.25f * static_cast<float>(number % 4) - 0.375f,
                      0.3f * static_cast<float>(number % 3) - 0.3f};
  frame.set_jitter(FrameJitter{.positions_px = {at}});
  frame.add(Aov::motion);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool is_bright = std::sin(0.35 * (x + at.x) + 0.21 * (y + at.y)) > 0.3;
      const double value = (is_bright ? 1.0 : 0.1) * (x >= left ? light : 1.0);
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = static_cast<float>((c + 1) * value);
    }
  }
  return frame;
}

std::vector<Image> results(gpu::Device& device, const AntialiasSettings& settings, const Light& light,
                           int left = 0) {
  std::vector<Frame> frames;
  for (int i = 0; i < kFrames; ++i) frames.push_back(stripes(i, light[i], left));
  AntialiasFilter filter(device, settings, kWidth, kHeight, frames.front().aovs(), {});
  FrameReport report;
  if (settings.directions == Directions::both) {
    for (int i = kFrames - 1; i >= 0; --i) {
      filter.run({.frame = i, .direction = Direction::backward, .new_history = i == kFrames - 1}, frames[i],
                 report);
    }
  }
  std::vector<Image> made;
  for (int i = 0; i < kFrames; ++i) {
    Frame result = *filter.run({.frame = i, .new_history = i == 0}, frames[i], report);
    made.push_back(std::move(result.image(Aov::beauty)));
  }
  return made;
}

double mean(const Image& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) sum += image.at(x, y, 1);
  }
  return sum / (image.width() * image.height());
}

using AntialiasLightTest = DeviceTest;

TEST_F(AntialiasLightTest, FlashesAndFadesKeepTheirEnergy) {
  Light still{}, flash{}, flare{}, fade{};
  for (int i = 0; i < kFrames; ++i) {
    still[i] = 1.0;
    flash[i] = i == 4 ? 4.0 : 1.0;
    flare[i] = i == 4 ? 1e4 : 1.0;
    fade[i] = std::pow(0.9, i);
  }
  for (const char* preset : {"forward", "best"}) {
    for (const int scale : {1, 2}) {
      AntialiasSettings settings = antialias_preset(preset);
      settings.scale = {.numerator = scale};
      const std::vector<Image> expected = results(device(), settings, still);
      for (const Light& light : {flash, flare, fade}) {
        const std::vector<Image> found = results(device(), settings, light);
        for (int i = 0; i < kFrames; ++i) {
          EXPECT_NEAR(mean(found[i]) / (light[i] * mean(expected[i])), 1.0, 0.01)
              << preset << ", scale " << scale << ", frame " << i << ", light " << light[4];
        }
      }
    }
  }
}

TEST_F(AntialiasLightTest, BesideALampTheHistoryStays) {
  Light still{}, lamp{};
  for (int i = 0; i < kFrames; ++i) {
    still[i] = 1.0;
    lamp[i] = i < 4 ? 1.0 : 4.0;
  }
  constexpr int left = kWidth / 2;
  constexpr int reach = 24;  // of a tile, its neighbours and the interpolation
  const AntialiasSettings settings = antialias_preset("forward");
  const std::vector<Image> expected = results(device(), settings, still);
  const std::vector<Image> found = results(device(), settings, lamp, left);
  for (int i = 0; i < kFrames; ++i) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < left - reach; ++x)
        ASSERT_NEAR(found[i].at(x, y, 1), expected[i].at(x, y, 1), 0.02) << i << ' ' << x << ',' << y;
    }
  }
}

}  // namespace
}  // namespace becalm::filter::antialias_light_test
