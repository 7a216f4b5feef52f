// For all settings, a frame merged in tiles is bit for bit the frame merged whole. A frame that cannot be cut
// small enough is an error.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "filter/sequence/sequence_filter.h"
#include "frame/error.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

AovSet diagnostics() {
  AovSet set;
  for (const AovInfo& entry : kAovTable) set.set(static_cast<std::size_t>(entry.aov), entry.diagnostic);
  return set;
}

struct Scene {
  int width;
  int height;
  bool variance = true;
  bool guides = true;
  bool motion = false;
  bool halves = false;
};

/// A pattern that moves by (19, -13) px per frame under noise, with a static band: it has motion across all
/// borders of tiles, fireflies, and some non-finite pixels.
Frame moving_frame(const Scene& scene, int number) {
  std::mt19937 random(number);
  std::normal_distribution<float> noise;
  Frame frame(number, scene.width, scene.height);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  if (scene.variance) frame.add(Aov::variance, 0.0025f);
  if (scene.guides) {
    frame.add(Aov::albedo);
    frame.add(Aov::normal);
    frame.add(Aov::depth);
    frame.add(Aov::object_id);
  }
  if (scene.motion) frame.add(Aov::motion);
  if (scene.halves) {
    frame.add(Aov::half_a);
    frame.add(Aov::half_b);
  }
  for (int y = 0; y < scene.height; ++y) {
    const bool still = y % 150 < 40;
    for (int x = 0; x < scene.width; ++x) {
      const double u = still ? x : x + 19.0 * number;
      const double v = still ? y : y - 13.0 * number;
      const auto value = static_cast<float>(0.1 + pattern(u, v, 9));
      const float firefly = random() % 40 == 0 ? 20.0f : 1.0f;
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = firefly * (value + 0.05f * noise(random));
      for (int c = 0; scene.halves && c < 3; ++c) {
        const float difference = 0.05f * noise(random);
        frame.image(Aov::half_a).at(x, y, c) = beauty.at(x, y, c) + difference;
        frame.image(Aov::half_b).at(x, y, c) = beauty.at(x, y, c) - difference;
      }
      if (scene.motion && !still) {
        // Motion is right, unknown, or far beyond the search's reach.
        const bool known = random() % 50 != 0;
        frame.image(Aov::motion).at(x, y, 0) = known ? 19.0f + (x / 60 % 5 == 4 ? 150.0f : 0.0f) : INFINITY;
        frame.image(Aov::motion).at(x, y, 1) = -13.0f;
      }
      if (!scene.guides) continue;
      for (int c = 0; c < 3; ++c) frame.image(Aov::albedo).at(x, y, c) = 0.8f * value;
      frame.image(Aov::normal).at(x, y, still ? 2 : 0) = 1.0f;
      frame.image(Aov::depth).at(x, y, 0) = 4.0f + value + static_cast<float>(still);
      frame.image(Aov::object_id).at(x, y, 0) = still ? 1.0f : 2.0f;
    }
  }
  for (int i = 0; i < 40; ++i) {
    const int x = static_cast<int>(random() % scene.width);
    const int y = static_cast<int>(random() % scene.height);
    beauty.at(x, y, 0) = std::numeric_limits<float>::quiet_NaN();
    if (scene.variance) frame.image(Aov::variance).at((x + 5) % scene.width, y, 1) = -1.0f;
    if (scene.guides) frame.image(Aov::albedo).at((x + 9) % scene.width, y, 2) = INFINITY;
  }
  return frame;
}

/// Noise that moves by `shift_px` to the left per frame; its motion AOV is that motion if `known`, else
/// infinity.
Frame fast_frame(int number, int shift_px, bool known) {
  constexpr int width = 1200;
  Frame frame(number, width, 48);
  frame.add(Aov::variance, 0.0025f);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& motion = frame.add(Aov::motion);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < width; ++x) {
      std::ranges::fill(beauty.pixel(x, y).first(3),
                        static_cast<float>(pattern(x + shift_px * number, y, 9)));
      motion.at(x, y, 0) = known ? static_cast<float>(shift_px) : INFINITY;
    }
  }
  return frame;
}

class FrameMergerTest : public DeviceTest {
 protected:
  static SequenceFilter make(const Settings& settings, const Scene& scene, std::uint64_t memory_limit) {
    return {device(),
            settings,
            scene.width,
            scene.height,
            moving_frame(scene, 1).aovs(),
            {.diagnostics = diagnostics(), .memory_limit = memory_limit}};
  }

  static void expect_same(const Denoised& tiled, const Denoised& whole) {
    for (const Aov aov : {Aov::beauty, Aov::variance, Aov::flow, Aov::error_mask, Aov::sample_count,
                          Aov::bias, Aov::gain, Aov::residual, Aov::accumulated, Aov::accumulated_variance}) {
      const auto a = tiled.frame.image(aov).data();
      const auto b = whole.frame.image(aov).data();
      std::size_t different = 0;
      std::size_t first = a.size();
      for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::bit_cast<std::uint32_t>(a[i]) == std::bit_cast<std::uint32_t>(b[i])) continue;
        first = std::min(first, i);
        ++different;
      }
      const std::size_t pixel = first / channel_count(aov);
      EXPECT_EQ(different, 0u) << "values of " << info(aov).name << ", the first at pixel "
                               << pixel % whole.frame.width() << ", " << pixel / whole.frame.width();
    }
    EXPECT_EQ(tiled.report.non_finite_pixels, whole.report.non_finite_pixels);
    EXPECT_EQ(tiled.report.replaced_variances, whole.report.replaced_variances);
    EXPECT_NEAR(tiled.report.mean_rejected, whole.report.mean_rejected, 1e-9);
    EXPECT_NEAR(tiled.report.mean_sample_count, whole.report.mean_sample_count, 1e-9);
  }

  /// Merges frames in tiles, within a share of the whole frame's memory; frame 4 starts a new history.
  static void expect_no_seams(const Settings& settings, const Scene& scene, double share, std::size_t tiles,
                              int frames = 3) {
    SequenceFilter whole = make(settings, scene, kUnlimited);
    ASSERT_EQ(whole.memory().tiles, 1u);
    const auto limit = static_cast<std::uint64_t>(share * static_cast<double>(whole.memory().device.total()));
    SequenceFilter tiled = make(settings, scene, limit);
    EXPECT_GE(tiled.memory().tiles, tiles);
    EXPECT_LE(tiled.memory().device.total(), limit);
    for (int number = 1; number <= frames; ++number) {
      SCOPED_TRACE("frame " + std::to_string(number));
      const Frame frame = moving_frame(scene, number);
      const bool new_history = number == 4;
      expect_same(denoise_frame(tiled, frame, new_history), denoise_frame(whole, frame, new_history));
    }
  }

  static void expect_no_seams_in_both_directions(const Settings& settings, const Scene& scene,
                                                 const std::vector<int>& frames = {1, 2, 3},
                                                 double share = 0.5, std::size_t least_tiles = 2) {
    SequenceFilter whole = make(settings, scene, kUnlimited);
    const auto limit = static_cast<std::uint64_t>(share * static_cast<double>(whole.memory().device.total()));
    SequenceFilter tiled = make(settings, scene, limit);
    EXPECT_GE(tiled.memory().tiles, least_tiles);
    EXPECT_LE(tiled.memory().device.total(), limit);
    const std::vector<Segment> segments = schedule(frames, {frames.begin(), frames.end()}, {.segment = 4});
    ASSERT_EQ(segments.size(), 1u);
    for (const Step& step : segments.front()) {
      SCOPED_TRACE("frame " + std::to_string(step.frame));
      const Frame frame = moving_frame(scene, step.frame);
      Denoised a, b;
      std::optional<Frame> of_tiles = tiled.run(step, frame, a.report);
      std::optional<Frame> of_whole = whole.run(step, frame, b.report);
      ASSERT_EQ(of_tiles.has_value(), step.direction == Direction::forward);
      ASSERT_EQ(of_whole.has_value(), of_tiles.has_value());
      if (!of_whole) continue;
      a.frame = std::move(*of_tiles);
      b.frame = std::move(*of_whole);
      expect_same(a, b);
    }
  }

  /// A preset without smoothing, whose margins are too large to cut small frames. Other tests below smooth.
  static Settings forward(const char* name) {
    Settings settings = preset(name);
    settings.directions = Directions::forward;
    settings.smooth = Smooth::none;
    return settings;
  }
};

TEST_F(FrameMergerTest, ShowsNoSeamsWhereBothDirectionsMeet) {
  Settings settings = forward("balanced");
  settings.directions = Directions::both;
  expect_no_seams_in_both_directions(settings, {.width = 357, .height = 325, .halves = true}, {1, 2, 3},
                                     0.35);
}

TEST_F(FrameMergerTest, ShowsNoSeamsWhereMergedFramesAreSmoothed) {
  Settings settings = forward("balanced");
  settings.directions = Directions::both;
  settings.smooth = Smooth::merged;
  // This memory holds the merge in one piece, but not the smoothing.
  expect_no_seams_in_both_directions(settings, {.width = 1000, .height = 405}, {1, 2}, 0.72, 1);
}

TEST_F(FrameMergerTest, ShowsNoSeamsUnderAnyPreset) {
  expect_no_seams(forward("draft"), {.width = 517, .height = 403}, 0.55, 2);
  for (const char* name : {"balanced", "final"}) {
    SCOPED_TRACE(name);
    expect_no_seams(forward(name), {.width = 357, .height = 325}, 0.5, 2);
  }
}

TEST_F(FrameMergerTest, ShowsNoSeamsBetweenManySmallTiles) {
  expect_no_seams(forward("final"), {.width = 325, .height = 293}, 0.12, 12, 4);
}

TEST_F(FrameMergerTest, ShowsNoSeamsUnderOtherSettings) {
  const Scene scene{.width = 229, .height = 229};
  const std::vector<std::vector<const char*>> all{{"merge=mask", "resample=bilinear"},
                                                  {"pyramid=4"},
                                                  {"blur_radius=10,3"},
                                                  {"patch_radius=8"},
                                                  {"guides=0", "blur_radius=5", "merge=mask"}};
  for (const std::vector<const char*>& assignments : all) {
    SCOPED_TRACE(assignments.front());
    Settings settings = forward("final");
    for (const char* assignment : assignments) set(settings, assignment);
    expect_no_seams(settings, scene, 0.23, 2, 2);
  }
}

TEST_F(FrameMergerTest, ShowsNoSeamsWithoutVarianceAndGuides) {
  expect_no_seams(forward("balanced"), {.width = 357, .height = 325, .variance = false, .guides = false}, 0.5,
                  2, 2);
}

TEST_F(FrameMergerTest, LeavesTheSmoothersEnoughMemory) {
  const Scene scene{.width = 300, .height = 200};
  const std::uint64_t whole = make(preset("balanced"), scene, kUnlimited).memory().device.total();
  for (const int percent : {75, 80, 90}) {
    EXPECT_NO_THROW(make(preset("balanced"), scene, whole / 100 * percent)) << percent << " % of " << whole;
  }
}

TEST_F(FrameMergerTest, ShowsNoSeamsWhereMotionIsKnown) {
  for (const std::vector<const char*>& assignments :
       {std::vector<const char*>{"motion=override"}, {"motion=guide"}}) {
    SCOPED_TRACE(assignments.back());
    Settings settings = forward("final");
    for (const char* assignment : assignments) set(settings, assignment);
    expect_no_seams(settings, {.width = 325, .height = 293, .motion = true}, 0.5, 2, 2);
  }
}

TEST_F(FrameMergerTest, FollowsKnownMotionUpToTheSameLimitAsWholeFrames) {
  Settings settings = forward("final");
  settings.pyramid.levels = 2;
  const Frame first = fast_frame(1, 0, true);
  const auto make_filter = [&](std::uint64_t limit) {
    return SequenceFilter(device(), settings, first.width(), first.height(), first.aovs(),
                          {.diagnostics = diagnostics(), .memory_limit = limit});
  };
  SequenceFilter whole = make_filter(kUnlimited);
  SequenceFilter tiled = make_filter(whole.memory().device.total() / 2);
  ASSERT_EQ(whole.memory().tiles, 1u);
  ASSERT_GE(tiled.memory().tiles, 2u);
  const auto second_of = [](SequenceFilter& filter, int shift_px, bool known) {
    denoise_frame(filter, fast_frame(1, shift_px, known), /*new_history=*/true);
    return denoise_frame(filter, fast_frame(2, shift_px, known));
  };
  const auto share_followed = [](const Denoised& denoised, int shift_px) {
    const Image& flow = denoised.frame.image(Aov::flow);
    int followed = 0;
    for (int x = 0; x + shift_px < flow.width(); ++x)
      followed += std::abs(flow.at(x, 24, 0) - shift_px) < 0.5f;
    return static_cast<double>(followed) / (flow.width() - shift_px);
  };
  {
    const Denoised near = second_of(whole, 250, true);
    EXPECT_GT(share_followed(near, 250), 0.95);
    EXPECT_EQ(near.report.far_motions, 0u);
    expect_same(second_of(tiled, 250, true), near);
  }
  const Denoised far = second_of(whole, 300, true);
  EXPECT_LT(share_followed(far, 300), 0.05);
  EXPECT_EQ(far.report.far_motions, first.image(Aov::beauty).pixel_count());
  expect_same(far, second_of(whole, 300, false));
  expect_same(second_of(tiled, 300, true), far);
}

TEST_F(FrameMergerTest, SeesTheWholeHistoryOnlyWhereKnownMotionIsTheOffset) {
  const Scene scene{.width = 4096, .height = 64, .motion = true};
  Settings settings = forward("final");
  set(settings, "motion=none");
  // In place, a tile's inputs and outputs take memory at once, and a larger share of the uncut frame's.
  const std::uint64_t parts = device().info().is_processor ? 4 : 7;
  const std::uint64_t limit = make(settings, scene, kUnlimited).memory().device.total() / parts;
  const auto reach_px = [&](const char* motion) {
    set(settings, motion);
    const FilterMemory memory = make(settings, scene, limit).memory();
    EXPECT_LE(memory.device.total(), limit) << motion;
    const std::string words = "history up to ";
    const std::size_t place = memory.tile_plan.find(words);
    return place != std::string::npos ? std::stoi(memory.tile_plan.substr(place + words.size())) : 0;
  };
  for (const char* motion : {"motion=none", "motion=guide"}) {
    EXPECT_GT(reach_px(motion), 0) << motion;
    EXPECT_LT(reach_px(motion), 2048) << motion;
  }
  EXPECT_GT(reach_px("motion=override"), 3000);
}

TEST_F(FrameMergerTest, TakesLongAndTinyFrames) {
  Settings settings = forward("balanced");
  for (const Scene scene : {Scene{.width = 16384, .height = 16}, {.width = 16, .height = 2500}}) {
    SCOPED_TRACE(scene.width);
    expect_no_seams(settings, scene, 0.5, 2, 2);
  }
  SequenceFilter filter = make(preset("balanced"), {.width = 1, .height = 1}, std::uint64_t{4} << 20);
  EXPECT_EQ(filter.memory().tiles, 1u);
}

TEST_F(FrameMergerTest, IsRefusedWhereTheSmallestTilesAreTooLarge) {
  try {
    make(forward("balanced"), {.width = 517, .height = 403}, 1 << 20);
    FAIL() << "517x403 px within 1 MiB";
  } catch (const gpu::DeviceLimitError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with("frames of 517x403 px cannot be cut small enough: even tiles of "))
        << message;
    EXPECT_TRUE(message.ends_with(" MiB of device memory, more than the 1.00 MiB that are left for them"))
        << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace becalm::filter
