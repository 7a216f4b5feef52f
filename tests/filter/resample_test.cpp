// Reading the history between its pixels.
#include <algorithm>
#include <random>

#include "filter/merge/merge.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/merge.h"

namespace becalm::filter::resample_test {
namespace {

using reference::Estimate;
using reference::Grid;
using reference::Rgba;
using reference::Vec2;

constexpr int kWidth = 61;
constexpr int kHeight = 43;

/// A chain with only the warp's passes.
class WarpOnDevice {
 public:
  WarpOnDevice(gpu::Device& device, Resample resample) : chain_(device, "warp test") {
    Settings settings = preset("final");
    settings.resample = resample;
    const gpu::Extent full{kWidth, kHeight};
    offset_ = chain_.input("offset", gpu::Format::f32x2, full);
    color_ = chain_.input("color", gpu::Format::f32x4, full);
    stats_ = chain_.input("stats", gpu::Format::f32x2, full);
    warped_ = add_warp_passes(chain_, settings, full, {.color = color_, .stats = stats_}, offset_);
    chain_.output(warped_.color);
    chain_.output(warped_.stats);
    chain_.build();
  }

  Grid<Estimate> run(const Grid<Estimate>& history, const Grid<Vec2>& offset) {
    upload_estimate(chain_, color_, stats_, history);
    upload_offset(chain_, offset_, offset);
    chain_.run();
    return download_estimate(chain_, warped_.color, warped_.stats, {kWidth, kHeight});
  }

 private:
  gpu::Chain chain_;
  gpu::ImageId offset_, color_, stats_;
  WarpedHistory warped_;
};

class ResampleTest : public DeviceTest {};

TEST_F(ResampleTest, TheSplinePassesThroughPixelsAndKeepsWavesBetterThanCatmullRom) {
  const auto wave = [](double x, double y) { return 0.5 + 0.4 * std::sin(1.6 * x) * std::cos(1.1 * y); };
  Grid<Estimate> history(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) history.at(x, y) = {{wave(x, y), 0.3, 0.3, 1.0}, 1.0, 1.0};
  }
  const auto error = [&](Resample resample, Vec2 shift) {
    const Grid<Estimate> found =
        WarpOnDevice(device(), resample).run(history, Grid<Vec2>(kWidth, kHeight, shift));
    double squares = 0.0;
    for (int y = 9; y < kHeight - 9; ++y) {
      for (int x = 9; x < kWidth - 9; ++x) {
        squares += std::pow(found.at(x, y).color[0] - wave(x + shift.x, y + shift.y), 2);
        EXPECT_NEAR(found.at(x, y).color[1], 0.3, 1e-6) << "an even channel";
      }
    }
    return squares;
  };
  EXPECT_NEAR(error(Resample::spline, {2.0, -1.0}), 0.0, 1e-9);
  EXPECT_LT(error(Resample::spline, {0.3, 0.2}), 0.7 * error(Resample::catmull_rom, {0.3, 0.2}));
}

/// Uncorrelated detail in three channels, with some fireflies; alpha is 1.
Grid<Estimate> detailed_history() {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform;
  Grid<Estimate> history(kWidth, kHeight);
  for (Estimate& e : history.data) {
    const float firefly = random() % 50 == 0 ? 10.0f : 1.0f;
    e = {{uniform(random) * firefly, uniform(random), uniform(random), 1.0},
         uniform(random),
         1 + 9 * uniform(random)};
  }
  return history;
}

/// Offsets of all subpixel phases, including whole pixels, that lead outside the image at its borders.
Grid<Vec2> all_phases() {
  Grid<Vec2> offset(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) offset.at(x, y) = {(x % 9 - 4) * 0.375, (y % 9 - 4) * 0.625};
  }
  return offset;
}

TEST_F(ResampleTest, AgreesWithTheReferenceAroundHolesToo) {
  Grid<Estimate> history = detailed_history();
  for (const auto& [x, y] : {std::pair{12, 9}, {13, 9}, {40, 30}, {0, 0}}) history.at(x, y).count = 0;
  const Grid<Vec2> offset = all_phases();
  for (const Resample resample : {Resample::bilinear, Resample::catmull_rom}) {
    const Grid<Estimate> found = WarpOnDevice(device(), resample).run(history, offset);
    const Grid<Estimate> truth = reference::warp(history, offset, resample);
    for (std::size_t i = 0; i < found.data.size(); ++i) {
      SCOPED_TRACE(testing::Message() << "filter " << static_cast<int>(resample) << " pixel " << i % kWidth
                                      << "," << i / kWidth);
      for (int c = 0; c < 4; ++c) {
        ASSERT_NEAR(found.data[i].color[c], truth.data[i].color[c],
                    1e-3 * std::abs(truth.data[i].color[c]) + 1e-4);
      }
      ASSERT_NEAR(found.data[i].variance, truth.data[i].variance, 1e-5);
      ASSERT_NEAR(found.data[i].count, truth.data[i].count, 1e-4);
    }
  }
}

TEST_F(ResampleTest, LimitsAllChannelsAlikeWithinTheRangeOfTheBilinearTaps) {
  const Grid<Estimate> history = detailed_history();
  const Grid<Vec2> offset = all_phases();
  Grid<Rgba> colors(kWidth, kHeight);
  for (std::size_t i = 0; i < colors.data.size(); ++i) colors.data[i] = history.data[i].color;
  const Grid<Estimate> bilinear = WarpOnDevice(device(), Resample::bilinear).run(history, offset);
  const Grid<Estimate> limited = WarpOnDevice(device(), Resample::catmull_rom).run(history, offset);
  int limits = 0;
  for (int y = 4; y < kHeight - 4; ++y) {
    for (int x = 4; x < kWidth - 4; ++x) {
      const Vec2 at{x + offset.at(x, y).x, y + offset.at(x, y).y};
      const Rgba sharp = reference::read_sharp(colors, at.x, at.y);
      const Rgba& soft = bilinear.at(x, y).color;
      const Rgba& out = limited.at(x, y).color;
      // The share, measured in the channel with the largest relative difference.
      int widest = 0;
      double scale = 0;
      for (int c = 0; c < 3; ++c) {
        const double size = std::abs(sharp[c] - soft[c]) / (std::abs(soft[c]) + 1e-3);
        if (size > scale) widest = c;
        scale = std::max(scale, size);
      }
      if (scale < 0.05) continue;
      const double share = (out[widest] - soft[widest]) / (sharp[widest] - soft[widest]);
      ASSERT_GE(share, -1e-3);
      ASSERT_LE(share, 1 + 2e-2);
      limits += share < 0.99 ? 1 : 0;
      const int x0 = static_cast<int>(std::floor(at.x));
      const int y0 = static_cast<int>(std::floor(at.y));
      for (int c = 0; c < 4; ++c) {
        ASSERT_NEAR(out[c], soft[c] + share * (sharp[c] - soft[c]),
                    1e-2 * std::abs(sharp[c] - soft[c]) + 2e-3 * std::abs(soft[c]) + 1e-3)
            << "channel " << c << " pixel " << x << "," << y;
        const auto [low, high] =
            std::minmax({history.at(x0, y0).color[c], history.at(x0 + 1, y0).color[c],
                         history.at(x0, y0 + 1).color[c], history.at(x0 + 1, y0 + 1).color[c]});
        ASSERT_GE(out[c], low);
        ASSERT_LE(out[c], high);
      }
    }
  }
  EXPECT_GT(limits, 100) << "pixels must be limited for this test to mean something";
}

TEST_F(ResampleTest, IsLinearWhereNothingIsLimited) {
  // On slopes without extrema no result leaves the range of the nearest taps.
  Grid<Estimate> direct(kWidth, kHeight), indirect(kWidth, kHeight), sum(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float a = 1.0f + 0.5f * x + 0.01f * x * x;
      const float b = 3.0f + 0.25f * y;
      direct.at(x, y) = {{a, a + 1, 2 * a, 0}, 0.1, 2};
      indirect.at(x, y) = {{b, 2 * b, b, 0}, 0.1, 2};
      sum.at(x, y) = {{a + b, a + 1 + 2 * b, 2 * a + b, 0}, 0.1, 2};
    }
  }
  const Grid<Vec2> offset(kWidth, kHeight, {0.375, -0.25});
  {
    constexpr Resample resample = Resample::catmull_rom;
    WarpOnDevice warp(device(), resample);
    const Grid<Estimate> parts[] = {warp.run(direct, offset), warp.run(indirect, offset)};
    const Grid<Estimate> whole = warp.run(sum, offset);
    for (int y = 12; y < kHeight - 12; ++y) {
      for (int x = 12; x < kWidth - 12; ++x) {
        for (int c = 0; c < 3; ++c) {
          const double expected = parts[0].at(x, y).color[c] + parts[1].at(x, y).color[c];
          ASSERT_NEAR(whole.at(x, y).color[c], expected, 1e-5 * expected) << x << "," << y;
        }
      }
    }
  }
}

TEST_F(ResampleTest, KeepsConstantsAndWholePixelShiftsBitForBit) {
  Grid<Estimate> constant(kWidth, kHeight);
  for (Estimate& e : constant.data) e = {{0.3f, 1e-20f, 7e8f, 1}, 0.1, 2};
  const Grid<Estimate> detail = detailed_history();
  const Grid<Vec2> whole(kWidth, kHeight, {2, -1});
  for (const Resample resample : {Resample::bilinear, Resample::catmull_rom}) {
    WarpOnDevice warp(device(), resample);
    for (const Estimate& e : warp.run(constant, all_phases()).data) {
      if (e.count == 0) continue;
      ASSERT_EQ(e.color, constant.data[0].color) << static_cast<int>(resample);
    }
    const Grid<Estimate> shifted = warp.run(detail, whole);
    for (int y = 1; y < kHeight; ++y) {
      for (int x = 0; x < kWidth - 2; ++x) ASSERT_EQ(shifted.at(x, y).color, detail.at(x + 2, y - 1).color);
    }
  }
}

TEST_F(ResampleTest, AFireflyNeitherRingsNorMakesNegativeRadiance) {
  // One bright pixel on a dim surface, moved back and forth many times.
  {
    constexpr Resample resample = Resample::catmull_rom;
    WarpOnDevice warp(device(), resample);
    Grid<Estimate> history(kWidth, kHeight);
    for (Estimate& e : history.data) e = {{0.5, 0, 0.25, 1}, 1.0, 1.0};
    history.at(30, 20).color = {1e6, 1e6, 0.25, 1};
    for (int frame = 0; frame < 6; ++frame) {
      history = warp.run(history, Grid<Vec2>(kWidth, kHeight, {frame % 2 ? 0.5 : -0.5, 0.25}));
      for (const Estimate& e : history.data) {
        if (e.count == 0) continue;
        ASSERT_GE(e.color[0], 0.5);
        ASSERT_LE(e.color[0], 1e6);
        ASSERT_GE(e.color[1], 0.0);
        ASSERT_EQ(e.color[2], 0.25) << "a channel without the firefly";
      }
    }
  }
}

}  // namespace
}  // namespace becalm::filter::resample_test
