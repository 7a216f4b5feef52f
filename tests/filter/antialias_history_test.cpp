// Which history a pixel of temporal antialiasing gets, and what rejects it. Histories are averaged, and
// blends tell how much of them is left.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "filter/antialias/antialias_filter.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::antialias_history_test {
namespace {

constexpr int kWidth = 61;
constexpr int kHeight = 43;

AntialiasSettings forward_settings(const std::vector<const char*>& changes) {
  AntialiasSettings settings = antialias_preset("forward");
  for (const char* change : changes) set(settings, change);
  return settings;
}

/// Even grey without motion.
Frame even(int number, float grey) {
  Frame frame(number, kWidth, kHeight);
  std::ranges::fill(frame.add(Aov::beauty, 1.0f).data(), grey);
  frame.add(Aov::motion);
  return frame;
}

Frame run(AntialiasFilter& filter, const Frame& frame) {
  FrameReport report;
  return *filter.run({.frame = frame.number()}, frame, report);
}

/// The row in the middle of the second result.
std::vector<float> second_result(gpu::Device& device, const std::vector<const char*>& changes,
                                 const Frame& first, const Frame& second) {
  AntialiasFilter filter(device, forward_settings(changes), first.width(), first.height(), first.aovs(), {});
  run(filter, first);
  const Frame result = run(filter, second);
  std::vector<float> row;
  for (int x = 0; x < kWidth; ++x) row.push_back(result.image(Aov::beauty).at(x, kHeight / 2, 0));
  return row;
}

using AntialiasHistoryTest = DeviceTest;

TEST_F(AntialiasHistoryTest, TheInvertedMaskAveragesOnlyWherePatchesDiffer) {
  const std::vector<const char*> settings{"reproject=search", "accumulate=exponential", "rectify=none",
                                          "mask=yes"};
  const auto textured = [](int number, float right) {
    Frame frame = even(number, 0.0f);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double seen = x < kWidth / 2 ? pattern(x, y, 3) : right * pattern(x, y, number + 4);
        for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(x, y, c) = static_cast<float>(0.2 + seen);
      }
    }
    return frame;
  };
  const Frame second = textured(1, 4.0f);
  const std::vector<float> row = second_result(device(), settings, textured(0, 1.0f), second);
  const auto given = [&](int x) { return second.image(Aov::beauty).at(x, kHeight / 2, 0); };
  for (int x = 4; x < kWidth / 2 - 8; ++x) EXPECT_NEAR(row[x], given(x), 1e-3f) << x;
  float largest = 0.0f;
  for (int x = kWidth / 2 + 8; x < kWidth - 4; ++x) largest = std::max(largest, std::abs(row[x] - given(x)));
  EXPECT_GT(largest, 0.3f);
}

TEST_F(AntialiasHistoryTest, FadesOfAnySizeAreAveragedWithoutLimit) {
  for (const char* reproject : {"reproject=vectors", "reproject=search"}) {
    for (const auto& levels :
         {std::vector{2e-12f, 1.0f, 1e7f, 1e7f}, {2e12f, 9e11f}, {1e18f, 0.0f, 1e-18f}}) {
      AntialiasFilter filter(device(), forward_settings({reproject, "accumulate=exponential"}), kWidth,
                             kHeight, even(0, 1.0f).aovs(), {});
      double average = levels.front();
      for (int number = 0; number < static_cast<int>(levels.size()); ++number) {
        average += 0.1 * (levels[number] - average);
        const auto mean = static_cast<float>(average);
        EXPECT_NEAR(run(filter, even(number, levels[number])).image(Aov::beauty).at(20, 20, 0), mean,
                    1e-5f * mean)
            << reproject << ' ' << levels.front() << ' ' << number;
      }
    }
  }
}

TEST_F(AntialiasHistoryTest, BrightPixelsOverFaintOnesAreNotLimited) {
  Frame frame = even(0, 1e-20f);
  frame.image(Aov::beauty).at(20, 20, 0) = 100.0f;
  AntialiasFilter filter(device(), forward_settings({"reconstruct=no"}), kWidth, kHeight, frame.aovs(), {});
  EXPECT_EQ(run(filter, frame).image(Aov::beauty).at(20, 20, 0), 100.0f);
}

TEST_F(AntialiasHistoryTest, PredictionsAreBroughtToTheFramesScale) {
  AntialiasFilter filter(device(), forward_settings({"directions=both", "reproject=vectors"}), kWidth,
                         kHeight, even(0, 1.0f).aovs(), {});
  std::vector<Frame> frames;
  for (int number = 0; number < 3; ++number) frames.push_back(even(number, number == 0 ? 1.0f : 1e-20f));
  FrameReport report;
  for (int i = 2; i >= 0; --i)
    filter.run({.frame = i, .direction = Direction::backward, .new_history = i == 2}, frames[i], report);
  for (int i = 0; i < 3; ++i) {
    const Frame result = *filter.run({.frame = i, .new_history = i == 0}, frames[i], report);
    const float truth = i == 0 ? 1.0f : 1e-20f;
    EXPECT_NEAR(result.image(Aov::beauty).at(20, 20, 0), truth, 1e-3f * truth) << i;
  }
}

/// The left half of the frames is black.
TEST_F(AntialiasHistoryTest, APredictionByFarBrighterFramesIsDropped) {
  const std::vector<std::vector<float>> shots{{1e-30f, 1e30f}, {1e30f, 1e-30f, 1e30f}};
  for (const char* preset : {"best", "clamping", "gain"}) {
    for (const std::vector<float>& levels : shots) {
      std::vector<Frame> frames;
      for (int number = 0; number < static_cast<int>(levels.size()); ++number) {
        frames.push_back(even(number, 0.0f));
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) {
            const std::span<float> color = frames.back().image(Aov::beauty).pixel(x, y);
            if (x >= kWidth / 2) std::ranges::fill(color.first(3), levels[number]);
            color[3] = 0.5f;
          }
        }
      }
      AntialiasSettings settings = antialias_preset(preset);
      settings.directions = Directions::both;
      AntialiasFilter filter(device(), settings, kWidth, kHeight, frames.front().aovs(), {});
      const int last = static_cast<int>(frames.size()) - 1;
      FrameReport report;
      for (int i = last; i >= 0; --i) {
        filter.run({.frame = i, .direction = Direction::backward, .new_history = i == last}, frames[i],
                   report);
      }
      for (int i = 0; i <= last; ++i) {
        const Frame result = *filter.run({.frame = i, .new_history = i == 0}, frames[i], report);
        const std::span<const float> values = result.image(Aov::beauty).data();
        for (std::size_t k = 0; k < values.size(); ++k) {
          ASSERT_TRUE(std::isfinite(values[k])) << preset << ' ' << i;
          ASSERT_TRUE(k % 4 != 3 || values[k] == 0.5f) << preset << ' ' << i << ' ' << values[k];
        }
        if (i > 0) continue;
        const float found = result.image(Aov::beauty).at(kWidth - 8, 20, 0);
        EXPECT_NEAR(found / levels[0], 1.0f, 1e-3f) << preset;
      }
    }
  }
}

/// A black square that moves by 8 pixels a frame over empty ground, with its vectors.
TEST_F(AntialiasHistoryTest, BlackThingsLeaveNoOpaqueTrail) {
  const auto with_square = [](int number) {
    Frame frame = even(number, 0.0f);
    frame.add(Aov::depth, 10.0f);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool inside = x >= 8 * number && x < 8 * number + 10;
        frame.image(Aov::beauty).at(x, y, 3) = inside ? 1.0f : 0.0f;
        if (!inside) continue;
        frame.image(Aov::motion).at(x, y, 0) = -8.0f;
        frame.image(Aov::depth).at(x, y, 0) = 1.0f;
      }
    }
    return frame;
  };
  for (const char* preset : {"forward", "clamping"}) {
    const AntialiasSettings settings = antialias_preset(preset);
    const Frame first = with_square(0);
    AntialiasFilter filter(device(), settings, kWidth, kHeight, first.aovs(), {});
    for (int number = 0; number < 4; ++number) run(filter, with_square(number));
    const Frame result = run(filter, with_square(4));
    for (int x = 0; x < 30; ++x)
      EXPECT_NEAR(result.image(Aov::beauty).at(x, kHeight / 2, 3), 0.0f, 1e-4f) << preset << ' ' << x;
    EXPECT_NEAR(result.image(Aov::beauty).at(37, kHeight / 2, 3), 1.0f, 1e-4f) << preset;
  }
}

/// The frame before a change, whose prediction by the frames after it the same rules reject.
TEST_F(AntialiasHistoryTest, WhatRejectsAHistoryRejectsThePrediction) {
  const std::vector<std::vector<const char*>> cases{
      {"accumulate=gain"}, {"accumulate=exponential", "rectify=clamp"}, {}};
  for (std::vector<const char*> changes : cases) {
    changes.insert(changes.end(), {"directions=both", "reproject=vectors", "reconstruct=no"});
    std::vector<Frame> frames;
    for (int number = 0; number < 6; ++number) frames.push_back(even(number, number < 3 ? 0.25f : 0.75f));
    AntialiasFilter filter(device(), forward_settings(changes), kWidth, kHeight, frames.front().aovs(), {});
    FrameReport report;
    for (int i = 5; i >= 0; --i)
      filter.run({.frame = i, .direction = Direction::backward, .new_history = i == 5}, frames[i], report);
    for (int i = 0; i < 3; ++i) {
      const Frame result = *filter.run({.frame = i, .new_history = i == 0}, frames[i], report);
      EXPECT_NEAR(result.image(Aov::beauty).at(20, 20, 0), 0.25f, 1e-3f) << changes.front() << ' ' << i;
    }
  }
}

/// The mean count of frames in the fourth result of a still edge.
double count_of_still_edge(gpu::Device& device, const Scale& scale, const std::vector<const char*>& changes) {
  AntialiasSettings settings = forward_settings(changes);
  settings.scale = scale;
  const auto edge = [&](int number) {
    Frame frame = even(number, 0.2f);
    const float at = 0.3f * static_cast<float>(number % 3) - 0.3f;
    frame.set_jitter(FrameJitter{.positions_px = {{at, 0.0f}}});
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (static_cast<float>(x) + at < 30.4f + 0.2f * static_cast<float>(y)) continue;
        for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(x, y, c) = 0.8f;
      }
    }
    return frame;
  };
  AntialiasFilter filter(device, settings, kWidth, kHeight, edge(0).aovs(), {});
  FrameReport report;
  for (int number = 0; number < 4; ++number) filter.run({.frame = number}, edge(number), report);
  return report.mean_sample_count;
}

TEST_F(AntialiasHistoryTest, AConstantWeightTakesSparseFramesForWhatTheyAreWorth) {
  const double exponential =
      count_of_still_edge(device(), {4, 1}, {"reproject=vectors", "accumulate=exponential"});
  EXPECT_GT(exponential,
            0.8 * count_of_still_edge(device(), {4, 1}, {"reproject=vectors", "accumulate=gain"}));
}

TEST_F(AntialiasHistoryTest, WhereAFrameWasCutTheFilterFillsIn) {
  AntialiasSettings settings = forward_settings({"reproject=vectors"});
  settings.scale = {3, 2};
  Frame cut = even(0, 0.25f);
  const Imath::Box2i seen({3, 3}, {kWidth - 4, kHeight - 4});
  std::size_t unknown = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (seen.intersects(Imath::V2i(x, y))) continue;
      std::ranges::fill(cut.image(Aov::beauty).pixel(x, y).first(3), std::nanf(""));
      ++unknown;
    }
  }
  cut.set_cut(Cut{seen, unknown});
  AntialiasFilter filter(device(), settings, kWidth, kHeight, cut.aovs(), {});
  FrameReport report;
  const Frame result = *filter.run({.frame = 0}, cut, report);
  EXPECT_EQ(report.non_finite_pixels, 0u);
  for (const float value : result.image(Aov::beauty).data()) ASSERT_TRUE(std::isfinite(value));
}

/// A texture that is sheared around the middle row, by a pixel each eight rows and frame; the window begins
/// at `origin` in the image plane.
Frame sheared(int number, Imath::V2i origin) {
  Frame frame(number, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < kHeight; ++y) {
    const double moved = number * (y + origin.y - 0.5 * kHeight) / 8.0;
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        beauty.at(x, y, c) = static_cast<float>(pattern(x + origin.x + moved, y + origin.y, 3));
      }
    }
  }
  return frame;
}

TEST_F(AntialiasHistoryTest, AScaledWindowReadsOffsetsAtItsPlace) {
  const Scale scale{3, 2};
  for (const Imath::V2i& origin : {Imath::V2i(0, 0), Imath::V2i(1, 1)}) {
    AntialiasSettings settings = forward_settings({"reproject=search"});
    settings.scale = scale;
    const Frame first = sheared(0, origin);
    SequenceOptions options{.diagnostics = {}, .origin = origin};
    options.diagnostics.set(static_cast<std::size_t>(Aov::flow));
    AntialiasFilter filter(device(), settings, first.width(), first.height(), first.aovs(), options);
    run(filter, first);
    const Frame result = run(filter, sheared(1, origin));
    const Image& flow = result.image(Aov::flow);
    double error = 0.0;
    int count = 0;
    for (int y = 9; y < flow.height() - 9; ++y) {
      const double row = (y + scale.edge(origin.y) + 0.5) / scale.value() - 0.5;
      for (int x = 9; x < flow.width() - 9; ++x, ++count) {
        error += flow.at(x, y, 0) - scale.value() * (row - 0.5 * kHeight) / 8.0;
      }
    }
    EXPECT_NEAR(error / count, 0.0, 0.02) << origin.x;
  }
}

}  // namespace
}  // namespace becalm::filter::antialias_history_test
