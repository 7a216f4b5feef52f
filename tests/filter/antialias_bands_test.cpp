// Antialiasing of frames that do not fit in storage buffers: passes run in bands, and results stay the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "filter/antialias/antialias_filter.h"
#include "filter/gpu/device_impl.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::antialias_bands_test {
namespace {

/// Of results: three bands, the last of which is a part of one.
constexpr int kWidth = 40;
constexpr int kHeight = 150;
/// Images of two floats fit, of those of four 75 rows, of which a band has 64.
constexpr std::uint32_t kLimit = 8 * kWidth * kHeight;

/// A moving picture with jitter, depth, and vectors that point out of the bands.
std::vector<Frame> shot(const Scale& scale) {
  const int width = kWidth / scale.numerator;
  const int height = kHeight / scale.numerator;
  std::vector<Frame> frames;
  for (int number = 0; number < 3; ++number) {
    Frame& frame = frames.emplace_back(number, width, height);
    frame.set_jitter(FrameJitter{.positions_px = {{0.3f - 0.25f * static_cast<float>(number), 0.125f}}});
    Image& beauty = frame.add(Aov::beauty, 1.0f);
    Image& depth = frame.add(Aov::depth, 1.0f);
    Image& vectors = frame.add(Aov::motion);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c)
          beauty.at(x, y, c) = static_cast<float>(0.2 + pattern(x + 2 * number, y + 3 * number, c));
        depth.at(x, y, 0) = static_cast<float>(1 + (x + y) % 7);
        vectors.at(x, y, 0) = -2.0f;
        vectors.at(x, y, 1) = y % 11 == 0 ? 40.5f : -3.0f;
      }
    }
  }
  return frames;
}

std::vector<Frame> results(gpu::Device& device, const AntialiasSettings& settings) {
  const std::vector<Frame> frames = shot(settings.scale);
  AntialiasFilter filter(device, settings, frames[0].width(), frames[0].height(), frames[0].aovs(), {});
  FrameReport report;
  const int last = static_cast<int>(frames.size()) - 1;
  for (int i = last; i >= 0; --i) {
    filter.run({.frame = i, .direction = Direction::backward, .new_history = i == last}, frames[i], report);
  }
  std::vector<Frame> made;
  for (int i = 0; i <= last; ++i) {
    made.push_back(*filter.run({.frame = i, .new_history = i == 0}, frames[i], report));
  }
  return made;
}

TEST(AntialiasBandsTest, ChangeNoBitOfTheResults) {
  gpu::Device whole({.select = "", .validation = true});
  gpu::Device banded({.select = "", .validation = true});
  banded.impl().limits.maxStorageBufferRange = kLimit;
  for (const std::string_view name : kAntialiasPresets) {
    for (const int scale : {1, 2}) {
      SCOPED_TRACE(std::string(name) + ", scale " + std::to_string(scale));
      AntialiasSettings settings = antialias_preset(name);
      settings.directions = Directions::both;  // or the rectified history is not written
      settings.scale = {.numerator = scale};
      const std::vector<Frame> expected = results(whole, settings);
      const std::vector<Frame> found = results(banded, settings);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(expected[i].width(), kWidth);
        EXPECT_TRUE(
            std::ranges::equal(found[i].image(Aov::beauty).data(), expected[i].image(Aov::beauty).data()))
            << "frame " << i;
      }
    }
  }
  EXPECT_TRUE(whole.validation_messages().empty());
  EXPECT_TRUE(banded.validation_messages().empty());
}

}  // namespace
}  // namespace becalm::filter::antialias_bands_test
