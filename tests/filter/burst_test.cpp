// Bursts: against the reference in doubles, and what must hold of any result.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "filter/burst/burst_chains.h"
#include "filter/burst/burst_merger.h"
#include "filter/burst/cfa_weights.h"
#include "filter/ceil_div.h"
#include "tests/filter/cfa_shots.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/reference/burst.h"

namespace becalm::filter {
namespace {

using namespace cfa_shots;
using reference::Grid;
using reference::Vec2;

Grid<double> grid_of(const Image& image) {
  Grid<double> grid(image.width(), image.height());
  std::ranges::copy(image.data(), grid.data.begin());
  return grid;
}

double rmse(const Image& a, const Image& b, int border) {
  double sum = 0.0, count = 0.0;
  for (int y = border; y < a.height() - border; ++y) {
    for (int x = border; x < a.width() - border; ++x, ++count)
      sum += (a.at(x, y, 0) - b.at(x, y, 0)) * (a.at(x, y, 0) - b.at(x, y, 0));
  }
  return std::sqrt(sum / count);
}

class BurstTest : public DeviceTest {
 protected:
  static BurstMerger merger(const CfaPattern& cfa, const Image& image,
                            std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max()) {
    return {device(), burst_aligner_settings(), cfa, image.width(), image.height(), memory_limit};
  }
  static Image merged(const CfaPattern& cfa, const std::vector<Image>& frames,
                      const NoiseModel& noise = kNoise) {
    BurstMerger merges = merger(cfa, frames.front());
    merges.start({.samples = frames.front(), .noise = noise}, kBalance);
    FrameReport report;
    for (std::size_t i = 1; i < frames.size(); ++i)
      merges.add({.samples = frames[i], .noise = noise}, report);
    return merges.merged();
  }
};

TEST_F(BurstTest, EqualsTheReferenceInDoubles) {
  for (const CfaPattern& cfa : patterns()) {
    Image target = photographed(cfa, 62, 50, {.shift = {}, .noise = 1.0, .seed = 1});
    Image source = photographed(cfa, 62, 50, {.shift = {1.4, -2.3}, .noise = 1.5, .seed = 2});
    for (int y = 20; y < 30; ++y) {  // another thing, saturated samples, and none
      for (int x = 10; x < 24; ++x) source.at(x, y, 0) = x < 13 ? 0.9f : 0.3f;
    }
    target.at(40, 30, 0) = 0.97f;
    reference::BurstLevels levels{.reference_noise = kNoise,
                                  .frame_noise = {.a = 3e-4, .b = 4e-6},
                                  .reference_saturated = 0.95,
                                  .frame_saturated = 0.8,
                                  .balance = {kBalance[0], kBalance[1], kBalance[2]}};
    BurstMerger merges = merger(cfa, target);
    merges.start({.samples = target, .noise = levels.reference_noise, .saturated = 0.95f}, kBalance);
    FrameReport report;
    merges.add({.samples = source, .noise = levels.frame_noise, .saturated = 0.8f}, report);
    const Image result = merges.merged();

    const Image offset = merges.offset();
    Grid<Vec2> blocks(offset.width(), offset.height());
    for (std::size_t i = 0; i < blocks.data.size(); ++i)
      blocks.data[i] = {offset.data()[2 * i] / merges.block(), offset.data()[2 * i + 1] / merges.block()};
    const auto expected =
        reference::burst_addition(grid_of(target), grid_of(source), blocks, merges.block(), cfa, levels);
    double largest = 0.0, weights = 0.0;
    for (int y = 0; y < target.height(); ++y) {
      for (int x = 0; x < target.width(); ++x) {
        const auto [sum, weight] = expected.at(x, y);
        weights += weight;
        largest =
            std::max(largest, std::abs((target.at(x, y, 0) + sum) / (1.0 + weight) - result.at(x, y, 0)));
      }
    }
    EXPECT_LT(largest, 2e-4);
    EXPECT_GT(weights, 0.5 * static_cast<double>(target.pixel_count())) << "most of the frame is merged";
    EXPECT_EQ(result.at(40, 30, 0), 0.97f) << "a saturated sample stays";
  }
}

TEST_F(BurstTest, MatchesBlocksOfAllColours) {
  for (const CfaPattern& cfa : patterns()) {
    // The last blocks are cut.
    const Image image = photographed(cfa, 63, 50, {.shift = {}, .noise = 1.0});
    const BurstTask task{.aligner = burst_aligner_settings(),
                         .cfa = cfa,
                         .full = {image.width(), image.height()},
                         .block = 2 * cfa.block()};
    BurstAlignPasses passes(device(), task);
    passes.chain.build();
    for (const gpu::ImageId mosaic : {passes.reference, passes.frame})
      std::ranges::copy(image.data(), passes.chain.upload<float>(mosaic).begin());
    const std::span<float> colors = passes.chain.upload<float>(passes.colors);
    std::copy_n(cfa.colors.begin(), colors.size(), colors.begin());
    const Levels levels{static_cast<float>(kNoise.a),
                        static_cast<float>(kNoise.b),
                        static_cast<float>(kNoise.a),
                        static_cast<float>(kNoise.b),
                        1.0f,
                        1.0f};
    std::ranges::copy(levels, passes.chain.upload<float>(passes.levels).begin());
    passes.chain.run();
    const auto found = passes.chain.download<float>(passes.target);
    const int columns = ceil_div(image.width(), task.block);
    const int rows = ceil_div(image.height(), task.block);
    ASSERT_EQ(found.size(), static_cast<std::size_t>(columns) * rows);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const double expected =
            reference::block_feature(grid_of(image), column, row, task.block, cfa, kNoise);
        ASSERT_NEAR(found[row * columns + column], expected, 1e-4 * expected) << column << "," << row;
      }
    }
  }
}

TEST_F(BurstTest, ReadsColoursBetweenPixels) {
  for (const CfaPattern& cfa : patterns()) {
    const std::vector<float> weights = cfa_weights(cfa, kBalance);
    Grid<double> even(24, 24), slope(24, 24);
    const auto grey = [](double x, double y) { return 0.3 + 0.01 * x - 0.02 * y; };
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 24; ++x) {
        even.at(x, y) = 0.1 + 0.2 * cfa.color(x, y);
        slope.at(x, y) = grey(x, y) / kBalance[cfa.color(x, y)];
      }
    }
    for (int color = 0; color < 3; ++color) {
      for (double y = 6.0; y < 12.0; y += 0.3125) {
        for (double x = 6.0; x < 12.0; x += 0.3125) {
          EXPECT_NEAR(reference::read(even, cfa, weights, color, x, y).value, 0.1 + 0.2 * color, 1e-5);
          // A slope has 0.02 a pixel.
          EXPECT_NEAR(reference::read(slope, cfa, weights, color, x, y).value * kBalance[color], grey(x, y),
                      2e-3)
              << x << ' ' << y << ' ' << color;
        }
      }
    }
    for (int y = 6; y < 12; ++y) {
      for (int x = 6; x < 12; ++x) {
        const reference::Read own = reference::read(slope, cfa, weights, cfa.color(x, y), x, y);
        EXPECT_NEAR(own.value, slope.at(x, y), 1e-6) << "a sample is itself";
        EXPECT_NEAR(own.ratio, 1.0, 1e-5);
      }
    }
  }
}

TEST_F(BurstTest, ReadsGreyThingsAlikeWhateverTheBalance) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform;
  for (const CfaPattern& cfa : {bayer(1), x_trans()}) {
    const std::vector<float> weights = cfa_weights(cfa, kBalance), of_equal = cfa_weights(cfa, {1, 1, 1});
    Grid<double> grey(18, 18), seen(18, 18);
    for (int y = 0; y < 18; ++y) {
      for (int x = 0; x < 18; ++x)
        seen.at(x, y) = (grey.at(x, y) = uniform(random)) / kBalance[cfa.color(x, y)];
    }
    for (int color = 0; color < 3; ++color) {
      EXPECT_NEAR(reference::read(seen, cfa, weights, color, 7.4375, 8.25).value * kBalance[color],
                  reference::read(grey, cfa, of_equal, color, 7.4375, 8.25).value, 1e-5);
    }
  }
}

TEST_F(BurstTest, LiftsOffsetsOfBlocksToTheMosaic) {
  constexpr Vec2 shift{3.3, -1.6};  // of the picture; the offset leads back
  for (const CfaPattern& cfa : patterns()) {
    const Image target = photographed(cfa, 126, 102, {.shift = {}, .noise = 0.0});
    const Image source = photographed(cfa, 126, 102, {.shift = shift, .noise = 0.0});
    BurstMerger merges = merger(cfa, target);
    merges.start({.samples = target, .noise = kNoise}, kBalance);
    FrameReport report;
    merges.add({.samples = source, .noise = kNoise}, report);
    const Image offset = merges.offset();
    double error = 0.0, count = 0.0;
    for (int y = 6; y < offset.height() - 6; ++y) {
      for (int x = 6; x < offset.width() - 6; ++x, ++count)
        error += std::hypot(offset.at(x, y, 0) + shift.x, offset.at(x, y, 1) + shift.y);
    }
    EXPECT_LT(error / count, 0.15);
    EXPECT_LT(rmse(merges.merged(), target, 12), 0.002);
    EXPECT_GT(merges.mean_weight(), 1.7) << "the frame counts";
  }
}

TEST_F(BurstTest, LowersNoiseByTheRootOfTheNumber) {
  for (const CfaPattern& cfa : {bayer(0), x_trans()}) {
    const Image truth = photographed(cfa, 126, 102, {.shift = {}, .noise = 0.0});
    std::vector<Image> frames;
    for (unsigned i = 0; i < 6; ++i)
      frames.push_back(
          photographed(cfa, 126, 102, {.shift = {0.7 * i, -0.45 * i}, .noise = 1.0, .seed = i + 1}));
    const double single = rmse(frames.front(), truth, 12);
    EXPECT_LT(rmse(merged(cfa, frames), truth, 12), 1.25 * single / std::sqrt(6.0));
  }
}

/// Light of many scales, so that there is something to match at every level of the search.
Image clouds(int width, int height) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Image image(width, height, 1, 0.3f);
  for (int cell = 256; cell >= 12; cell /= 2) {
    Grid<double> grid(width / cell + 2, height / cell + 2);
    for (double& value : grid.data) value = uniform(random);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        image.at(x, y, 0) += static_cast<float>(0.05 * bilinear(grid, double(x) / cell, double(y) / cell));
    }
  }
  return image;
}

TEST_F(BurstTest, MergesFramesThatAreFarOff) {
  constexpr int shift = 300;  // beyond what tiles read around them
  constexpr int side = 1024;
  const CfaPattern cfa = bayer(0);
  const Image light = clouds(side + shift, side + shift);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto photograph = [&](int corner, double noise) {
    Image image(side, side, 1);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const double value = light.at(x + corner, y + corner, 0) / kBalance[cfa.color(x, y)];
        const double deviation = std::sqrt(kNoise.a * value + kNoise.b);
        image.at(x, y, 0) = static_cast<float>(value + noise * deviation * normal(random));
      }
    }
    return image;
  };
  const Image truth = photograph(0, 0.0), target = photograph(0, 1.0), source = photograph(shift, 1.0);
  Settings aligner = burst_aligner_settings();
  set(aligner, "pyramid=2x7");
  const auto make = [&](std::uint64_t limit) {
    return BurstMerger(device(), aligner, cfa, side, side, limit);
  };
  const std::uint64_t whole = make(std::numeric_limits<std::uint64_t>::max()).memory().device.total();
  BurstMerger merges = make(whole * 2 / 10);
  ASSERT_GT(merges.memory().tiles, 4u);
  merges.start({.samples = target, .noise = kNoise}, kBalance);
  FrameReport report;
  merges.add({.samples = source, .noise = kNoise}, report);
  const Image result = merges.merged();
  double before = 0.0, after = 0.0;
  for (int y = shift + 24; y < side - 24; ++y) {
    for (int x = shift + 24; x < side - 24; ++x) {
      before += std::pow(target.at(x, y, 0) - truth.at(x, y, 0), 2.0);
      after += std::pow(result.at(x, y, 0) - truth.at(x, y, 0), 2.0);
    }
  }
  EXPECT_LT(std::sqrt(after / before), 0.73) << "0.716, and 1 where the frame is not merged";
}

TEST_F(BurstTest, KeepsWhatAllFramesAgreeOn) {
  for (const CfaPattern& cfa : {bayer(2), x_trans()}) {
    const Image frame = photographed(cfa, 48, 36, {.shift = {}, .noise = 1.0});
    EXPECT_LT(rmse(merged(cfa, {frame, frame, frame}), frame, 0), 1e-6) << "equal frames give that frame";
    for (const float value : {0.0f, 0.25f, 1.0f}) {
      const Image even(48, 36, 1, value);
      EXPECT_LT(rmse(merged(cfa, {even, even}), even, 0), 1e-6) << value;
    }
    EXPECT_EQ(rmse(merged(cfa, {frame}), frame, 0), 0.0) << "one frame";
  }
}

TEST_F(BurstTest, ThingsThatMoveLeaveNoGhost) {
  const CfaPattern cfa = bayer(0);
  std::vector<Image> frames;
  for (unsigned i = 0; i < 6; ++i) {
    Image frame = photographed(cfa, 126, 102, {.shift = {0.4 * i, 0.3 * i}, .noise = 1.0, .seed = i + 1});
    for (int y = 40; y < 64; ++y) {
      for (int x = 30 + 14 * static_cast<int>(i); x < std::min(50 + 14 * static_cast<int>(i), 126); ++x)
        frame.at(x, y, 0) = 0.05f;
    }
    frames.push_back(std::move(frame));
  }
  const Image result = merged(cfa, frames);
  double sum = 0.0;
  for (int y = 44; y < 60; ++y) {
    for (int x = 34; x < 46; ++x) sum += result.at(x, y, 0) - 0.05;
  }
  EXPECT_NEAR(sum / (16 * 12), 0.0, 0.001) << "what the others show there is not mixed in";
}

TEST_F(BurstTest, StaysFinite) {
  const CfaPattern cfa = bayer(1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const int side : {24, 25, 31}) {
    for (const float scale : {1e-30f, 1.0f, 1e30f}) {
      Image a = photographed(cfa, side, side, {.shift = {}, .noise = 1.0, .seed = 1});
      Image b = photographed(cfa, side, side, {.shift = {1, 1}, .noise = 1.0, .seed = 2});
      for (Image* image : {&a, &b}) {
        for (float& value : image->data()) value *= scale;
        image->at(5, 6, 0) = nan;
        image->at(7, 8, 0) = -infinity;
      }
      const Image result = merged(cfa, {a, b});
      for (const float value : result.data()) ASSERT_TRUE(std::isfinite(value)) << side << ' ' << scale;
    }
  }
}

TEST_F(BurstTest, TilesDoNotShow) {
  for (const CfaPattern& cfa : {bayer(0), x_trans()}) {
    for (const auto& [width, height] : {std::pair{360, 240}, {240, 360}}) {
      const Image target = photographed(cfa, width, height, {.shift = {}, .noise = 1.0, .seed = 1});
      const Image source = photographed(cfa, width, height, {.shift = {4.3, -2.6}, .noise = 1.0, .seed = 2});
      const auto run = [&](std::uint64_t limit) {
        BurstMerger merges = merger(cfa, target, limit);
        merges.start({.samples = target, .noise = kNoise}, kBalance);
        FrameReport report;
        merges.add({.samples = source, .noise = kNoise}, report);
        return std::pair(merges.merged(), merges.memory());
      };
      const auto [whole, memory] = run(std::numeric_limits<std::uint64_t>::max());
      const auto [cut, of_cut] = run(memory.device.total() * 8 / 10);
      ASSERT_EQ(memory.tiles, 1u);
      ASSERT_GT(of_cut.tiles, 1u);
      EXPECT_LT(rmse(whole, cut, 0), 1e-7) << of_cut.tile_plan;
    }
  }
}

}  // namespace
}  // namespace becalm::filter
