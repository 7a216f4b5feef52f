// Pairs of eyes: the chain against the reference in doubles, and what must hold of any result.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "filter/sequence/sequence_filter.h"
#include "filter/stereo/disparity.h"
#include "filter/stereo/eye_combiner.h"
#include "filter/stereo/eye_passes.h"
#include "filter/stereo/stereo_filter.h"
#include "frame/error.h"
#include "shaders/shared/limits.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/stereo.h"

namespace becalm::filter::stereo_test {
namespace {

using reference::Estimate;
using reference::Grid;

constexpr int kWidth = 96;
constexpr int kHeight = 64;
constexpr double kFar = 1e6;

/// A wall at z = 4, which has no disparity, and before it in the left third of the middle a card at z = 2.
/// Focal length 100 px, eyes 0.2 apart: the card's disparity is 100 * 0.2 * (1/2 - 1/4) = 5 px.
constexpr StereoCamera kCamera{.focal_px = 100.0, .separation = 0.2, .convergence = 4.0};
constexpr double kWallZ = 4.0, kCardZ = 2.0;
constexpr int kCardDisparity = 5;

struct Shot {
  bool card = false;
  bool depth = true;
  bool camera = true;
  double noise = 0.3;  ///< relative standard deviation
  double contrast = 1.0;
};

/// Whether the eye's pixel shows the card, which the left eye sees from column 30 to 50.
bool on_card(const Shot& shot, Eye eye, int x, int y) {
  const int in_left = eye == Eye::left ? x : x + kCardDisparity;
  return shot.card && in_left >= 30 && in_left < 50 && y >= 16 && y < 48;
}

double clean(const Shot& shot, Eye eye, int x, int y) {
  const bool card = on_card(shot, eye, x, y);
  const int in_left = eye == Eye::left || !card ? x : x + kCardDisparity;
  return (card ? 0.7 : 0.2) + shot.contrast * 0.6 * pattern(in_left, y, card ? 5 : 9);
}

Frame frame_of(const Shot& shot, Eye eye, int number = 1, unsigned seed = 0) {
  std::mt19937 random(seed * 7919 + number * 2 + (eye == Eye::left ? 0 : 1));
  std::normal_distribution<double> normal;
  Frame frame(number, kWidth, kHeight);
  if (shot.camera) frame.set_stereo(StereoView{kCamera, eye});
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance);
  if (shot.depth) frame.add(Aov::depth);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double value = clean(shot, eye, x, y);
      const double deviation = shot.noise * value;
      for (int c = 0; c < 3; ++c) {
        beauty.at(x, y, c) = static_cast<float>(value + deviation * normal(random));
        variance.at(x, y, c) = static_cast<float>(deviation * deviation);
      }
      const double z = on_card(shot, eye, x, y) ? kCardZ : kWallZ;
      const StereoView view{kCamera, eye};
      if (shot.depth) {
        frame.image(Aov::depth).at(x, y, 0) =
            static_cast<float>(z / view.cosine(x + 0.5, y + 0.5, kWidth, kHeight));
      }
    }
  }
  return frame;
}

Settings unsmoothed() {
  Settings settings = preset("draft");
  settings.smooth = Smooth::none;
  return settings;
}

StereoFilter::Pair<Frame> filter_pair(gpu::Device& device, const Settings& settings, const Frame& left,
                                      const Frame& right, const SequenceOptions& options = {}) {
  StereoFilter filter(device, settings, left.width(), left.height(), left.aovs(), options);
  StereoFilter::Pair<FrameReport> reports;
  auto results = filter.run({.frame = left.number()}, {&left, &right}, reports);
  return {std::move(*results[0]), std::move(*results[1])};
}

double mean_square(const Frame& frame, const Shot& shot, Eye eye) {
  double sum = 0;
  int count = 0;
  for (int y = 4; y < kHeight - 4; ++y) {
    for (int x = 12; x < kWidth - 12; ++x) {
      for (int c = 0; c < 3; ++c, ++count)
        sum += std::pow(frame.image(Aov::beauty).at(x, y, c) - clean(shot, eye, x, y), 2);
    }
  }
  return sum / count;
}

class StereoTest : public DeviceTest {};

TEST_F(StereoTest, TheChainAgreesWithTheReference) {
  constexpr double exposure = 1.3;
  constexpr int width = 47, height = 29;
  for (const Smooth smooth : {Smooth::none, Smooth::frames, Smooth::merged}) {
    FilterTask task{
        .settings = preset("draft"), .full = {width, height}, .used = {}, .diagnostics = {}, .guides = {}};
    task.settings.smooth = smooth;
    task.settings.patch_radius = 2;
    task.used.set(static_cast<std::size_t>(Aov::depth));
    EyePasses passes(device(), task, 16, task.full, task.full);
    passes.chain.build();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit;
    Grid<Estimate> own(width, height), other(width, height);
    Grid<reference::Vec2> given(width, height);
    Grid<double> depth(width, height), expected_depth(width, height), noisy_variance(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (Grid<Estimate>* grid : {&own, &other}) {
          Estimate& e = grid->at(x, y);
          for (double& channel : e.color) channel = static_cast<float>(pattern(x, y, 7) + 0.3 * unit(random));
          e.variance = static_cast<float>(0.05 * unit(random));
          e.count = unit(random) < 0.05 ? 0 : static_cast<float>(1 + 7 * unit(random));
        }
        noisy_variance.at(x, y) = x % 7 == 0 ? 0.0 : static_cast<float>(0.2 * unit(random));
        given.at(x, y) = {static_cast<float>(8 * unit(random) - 4), static_cast<float>(2 * unit(random) - 1)};
        expected_depth.at(x, y) = x < 5 ? 0 : 2;
        depth.at(x, y) = x % 11 == 0 ? std::numeric_limits<float>::infinity() : x / 8 % 3 == 2 ? 3.0 : 2.05;
      }
    }
    gpu::Chain& chain = passes.chain;
    chain.upload<float>(passes.exposure)[0] = exposure;
    std::ranges::fill(chain.upload<float>(passes.window.target_origin), 0.0f);
    upload_estimate(chain, passes.own.color, passes.own.stats, own);
    upload_estimate(chain, passes.other.color, passes.other.stats, other);
    for (const EstimateInputs* eye : {&passes.own, &passes.other}) {
      for (const gpu::ImageId image : eye->carried) std::ranges::fill(chain.upload<float>(image), 0.0f);
    }
    if (task.smooths_merged()) {
      const auto noisy = chain.upload<float>(passes.own.carried[FilterTask::kNoisyRadiance]);
      for (std::size_t i = 0; i < noisy_variance.data.size(); ++i)
        noisy[4 * i + 3] = static_cast<float>(noisy_variance.data[i]);
    }
    upload_offset(chain, passes.offset, given);
    for (std::size_t i = 0; i < depth.data.size(); ++i) {
      chain.upload<float>(*passes.other_depth)[i] = static_cast<float>(depth.data[i]);
      chain.upload<float>(*passes.expected_depth)[i] = static_cast<float>(expected_depth.data[i]);
    }
    chain.run();
    const Grid<Estimate> made = download_estimate(chain, passes.color, passes.stats, task.full);
    const auto offsets = reference::checked_offsets(given, expected_depth, depth);
    Grid<double> weights;
    const Grid<Estimate> expected =
        reference::blend_eyes(own, reference::warp(other, offsets, task.settings.resample), exposure,
                              task.settings.patch_radius, smooth, noisy_variance, weights);
    int taken = 0, refused = 0;
    for (std::size_t i = 0; i < made.data.size(); ++i) {
      const Estimate& a = made.data[i];
      const Estimate& b = expected.data[i];
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(a.color[c], b.color[c], 2e-4) << i;
      ASSERT_NEAR(a.variance, b.variance, 1e-4 + 1e-3 * b.variance) << i;
      ASSERT_NEAR(a.count, b.count, 1e-3 * (1 + b.count)) << i;
      ASSERT_NEAR(chain.download<float>(passes.weight)[i], weights.data[i], 2e-3) << i;
      taken += weights.data[i] > 0.2;
      refused += offsets.data[i].x == kFar;
    }
    EXPECT_GT(taken, 300);
    EXPECT_GT(refused, 100);
  }
}

TEST_F(StereoTest, EyesThatSeeTheSameGainLikeTwoSamples) {
  const Shot shot;
  const Frame left = frame_of(shot, Eye::left), right = frame_of(shot, Eye::right);
  const auto results =
      filter_pair(device(), unsmoothed(), left, right,
                  {.diagnostics = AovSet().set(static_cast<std::size_t>(Aov::sample_count))});
  const double alone = mean_square(left, shot, Eye::left);
  for (const Eye eye : {Eye::left, Eye::right}) {
    const Frame& result = results[eye == Eye::left ? 0 : 1];
    EXPECT_NEAR(mean_square(result, shot, eye) / alone, 0.5, 0.06);
    double variance = 0, count = 0, noise = 0;
    for (int i = 0; i < kWidth * kHeight; ++i) {
      variance += result.image(Aov::variance).data()[3 * i];
      noise += left.image(Aov::variance).data()[3 * i];
      count += result.image(Aov::sample_count).data()[i] / (kWidth * kHeight);
    }
    EXPECT_NEAR(variance / noise, 0.5, 0.06) << "the variance left is known";
    EXPECT_NEAR(count, 2.0, 0.1);
  }
}

TEST_F(StereoTest, FollowsTheDisparityByDepthOrBySearch) {
  for (const bool depth : {true, false}) {
    const Shot shot{.card = true, .depth = depth, .camera = depth, .noise = 0.1};
    const Frame left = frame_of(shot, Eye::left), right = frame_of(shot, Eye::right);
    const auto results =
        filter_pair(device(), unsmoothed(), left, right,
                    {.diagnostics = AovSet().set(static_cast<std::size_t>(Aov::stereo_weight))});
    double on = 0;
    for (int y = 22; y < 42; ++y) {
      for (int x = 36; x < 44; ++x) on += results[0].image(Aov::stereo_weight).at(x, y, 0) / (20 * 8);
    }
    EXPECT_GT(on, depth ? 0.4 : 0.3) << depth;
    EXPECT_LT(mean_square(results[0], shot, Eye::left), 0.7 * mean_square(left, shot, Eye::left)) << depth;
  }
}

TEST_F(StereoTest, ASearchedPairComparesTheDepthsOfOneSurface) {
  // At the card's right edge the other eye's pixel at the same place shows the wall.
  const Shot shot{.card = true, .camera = false, .noise = 0.1};
  const auto results =
      filter_pair(device(), unsmoothed(), frame_of(shot, Eye::left), frame_of(shot, Eye::right),
                  {.diagnostics = AovSet().set(static_cast<std::size_t>(Aov::stereo_weight))});
  double on = 0;
  for (int y = 22; y < 42; ++y) {
    for (int x = 45; x < 49; ++x) on += results[0].image(Aov::stereo_weight).at(x, y, 0) / (20 * 4);
  }
  EXPECT_GT(on, 0.25);
}

TEST_F(StereoTest, WhatTheOtherEyeDoesNotSeeStaysAsItIs) {
  // The card hides columns 25 to 29 of the wall from the right eye; the left eye sees them.
  const Shot shot{.card = true, .noise = 0.05, .contrast = 0.0};
  const Frame left = frame_of(shot, Eye::left), right = frame_of(shot, Eye::right);
  const auto results =
      filter_pair(device(), unsmoothed(), left, right,
                  {.diagnostics = AovSet().set(static_cast<std::size_t>(Aov::stereo_weight))});
  for (int y = 20; y < 44; ++y) {
    for (int x = 26; x < 29; ++x) {
      EXPECT_EQ(results[0].image(Aov::stereo_weight).at(x, y, 0), 0.0f) << x << ',' << y;
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(results[0].image(Aov::beauty).at(x, y, c), left.image(Aov::beauty).at(x, y, c));
    }
  }
}

TEST_F(StereoTest, SkyIsNoSurfaceThatTheOtherEyeSees) {
  const Shot shot{.noise = 0.05, .contrast = 0.0};
  Frame left = frame_of(shot, Eye::left);
  std::ranges::fill(left.image(Aov::depth).data(), std::numeric_limits<float>::infinity());
  const auto results =
      filter_pair(device(), unsmoothed(), left, frame_of(shot, Eye::right),
                  {.diagnostics = AovSet().set(static_cast<std::size_t>(Aov::stereo_weight))});
  for (const float weight : results[0].image(Aov::stereo_weight).data()) ASSERT_EQ(weight, 0.0f);
}

TEST_F(StereoTest, AConstantStaysConstantAtAnyScale) {
  for (const char* name : {"draft", "balanced"}) {
    for (const float value : {1e-30f, 0.5f, 1e30f}) {
      Frame left(1, kWidth, kHeight), right(1, kWidth, kHeight);
      for (Frame* frame : {&left, &right}) frame->add(Aov::beauty, value);
      const auto results = filter_pair(device(), preset(name), left, right);
      for (const Frame& result : results) {
        for (const float v : result.image(Aov::beauty).data()) ASSERT_NEAR(v / value, 1.0, 2e-3) << name;
      }
    }
  }
}

TEST_F(StereoTest, NaNOfOneEyeReachesNeither) {
  const Shot shot;
  Frame left = frame_of(shot, Eye::left);
  const Frame right = frame_of(shot, Eye::right);
  for (int x = 40; x < 44; ++x) {
    left.image(Aov::beauty).at(x, 30, 1) = std::numeric_limits<float>::quiet_NaN();
    left.image(Aov::depth).at(x, 31, 0) = std::numeric_limits<float>::quiet_NaN();
  }
  for (const char* name : {"draft", "balanced"}) {
    const auto results = filter_pair(device(), preset(name), left, right);
    for (const float v : results[1].image(Aov::beauty).data()) ASSERT_TRUE(std::isfinite(v)) << name;
    for (std::size_t i = 0; i < results[0].image(Aov::beauty).data().size(); ++i) {
      const bool was = std::isfinite(left.image(Aov::beauty).data()[i]);
      ASSERT_EQ(std::isfinite(results[0].image(Aov::beauty).data()[i]), was) << name << ' ' << i;
    }
  }
}

TEST_F(StereoTest, TheOrderOfTheEyesDoesNotMatter) {
  const Shot shot{.card = true};
  const Frame left = frame_of(shot, Eye::left), right = frame_of(shot, Eye::right);
  const auto results = filter_pair(device(), preset("draft"), left, right);
  const auto swapped = filter_pair(device(), preset("draft"), right, left);
  for (int eye = 0; eye < 2; ++eye) {
    const auto a = results[eye].image(Aov::beauty).data(), b = swapped[1 - eye].image(Aov::beauty).data();
    EXPECT_TRUE(std::ranges::equal(a, b));
  }
}

/// The shot's frame several times side by side.
Frame wide_frame_of(const Shot& shot, Eye eye, int width) {
  const Frame part = frame_of(shot, eye);
  Frame frame(1, width, kHeight);
  frame.set_stereo(part.stereo());
  for (const Aov aov : {Aov::beauty, Aov::variance, Aov::depth}) {
    if (!part.has(aov)) continue;
    Image& image = frame.add(aov);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < width; ++x)
        std::ranges::copy(part.image(aov).pixel(x % kWidth, y), image.pixel(x, y).begin());
    }
  }
  return frame;
}

TEST_F(StereoTest, TilesDoNotShow) {
  const Shot shot{.card = true};
  constexpr int width = 384;
  const Frame left = wide_frame_of(shot, Eye::left, width), right = wide_frame_of(shot, Eye::right, width);
  FilterTask task{.settings = unsmoothed(),
                  .full = {width, kHeight},
                  .used = left.aovs(),
                  .diagnostics = {},
                  .guides = {}};
  const NewFrame frames[] = {{.frame = left, .finite = {}, .exposure = 2.0f},
                             {.frame = right, .finite = {}, .exposure = 2.0f}};
  filter::Estimate estimates[] = {{task.full, 0}, {task.full, 0}};
  for (int eye = 0; eye < 2; ++eye) {
    estimates[eye].color = frames[eye].frame.image(Aov::beauty);
    for (std::size_t i = 0; i < estimates[eye].stats.pixel_count(); ++i) {
      estimates[eye].stats.data()[2 * i] = frames[eye].frame.image(Aov::variance).data()[3 * i];
      estimates[eye].stats.data()[2 * i + 1] = 1.0f;
    }
  }
  const Correspondence where = correspondence_by_depth(left, 30.0f);
  const auto run = [&](std::uint64_t limit) {
    EyeCombiner combiner(device(), task, 32, limit);
    Image weight(width, kHeight, 1);
    FrameReport report;
    const filter::Estimate made =
        combiner.run({frames[0], estimates[0]}, {frames[1], estimates[1]}, where, weight, report);
    return std::pair(made, combiner.memory());
  };
  const auto [whole, memory] = run(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(memory.tiles, 1u);
  const auto [cut, memory_of_cut] = run(memory.device.total() * 2 / 3);
  EXPECT_GT(memory_of_cut.tiles, 1u);
  EXPECT_TRUE(std::ranges::equal(whole.color.data(), cut.color.data()));
  EXPECT_TRUE(std::ranges::equal(whole.stats.data(), cut.stats.data()));
}

TEST_F(StereoTest, APairWhoseCamerasAreSearchedKeepsToTheMemory) {
  constexpr int width = 1152;
  const Shot shot{.card = true, .depth = false, .camera = false};
  const Frame left = wide_frame_of(shot, Eye::left, width), right = wide_frame_of(shot, Eye::right, width);
  const auto run = [&](std::uint64_t limit) {
    StereoFilter filter(device(), unsmoothed(), width, kHeight, left.aovs(), {.memory_limit = limit});
    StereoFilter::Pair<FrameReport> reports;
    auto results = filter.run({.frame = 1}, {&left, &right}, reports);
    return std::pair(std::move(results), filter.memory());
  };
  const auto [whole, memory] = run(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(memory.tile_plan, "1");
  const auto limit = memory.device.total() * 2 / 5;
  const auto [cut, memory_of_cut] = run(limit);
  EXPECT_LE(memory_of_cut.device.total(), limit);
  EXPECT_NE(memory_of_cut.tile_plan.find("eyes "), std::string::npos) << memory_of_cut.tile_plan;
  for (int eye = 0; eye < 2; ++eye) {
    EXPECT_TRUE(
        std::ranges::equal(whole[eye]->image(Aov::beauty).data(), cut[eye]->image(Aov::beauty).data()));
  }
  EXPECT_THROW(run(100'000), gpu::DeviceLimitError);
}

TEST(Disparity, IsThatOfTheCamera) {
  Frame frame(1, 64, 32);
  frame.set_stereo(StereoView{kCamera, Eye::left});
  Image& depth = frame.add(Aov::depth, std::numeric_limits<float>::infinity());
  const StereoView view{kCamera, Eye::left};
  depth.at(10, 5, 0) = static_cast<float>(kWallZ / view.cosine(10.5, 5.5, 64, 32));
  depth.at(11, 5, 0) = static_cast<float>(kCardZ / view.cosine(11.5, 5.5, 64, 32));
  depth.at(12, 5, 0) = std::numeric_limits<float>::quiet_NaN();
  depth.at(13, 5, 0) = 0.05f;
  const Correspondence where = correspondence_by_depth(frame, 50.0f);
  EXPECT_NEAR(where.offset.at(10, 5, 0), 0.0f, 1e-4f) << "the plane of convergence has none";
  EXPECT_NEAR(where.offset.at(11, 5, 0), -5.0f, 1e-4f) << "nearer points lie further left in the right eye";
  EXPECT_NEAR(where.offset.at(0, 0, 0), 100.0f * 0.2f / 4.0f, 1e-4f) << "those infinitely far further right";
  EXPECT_EQ(where.depth.at(0, 0, 0), std::numeric_limits<float>::infinity());
  const StereoView other{kCamera, Eye::right};
  EXPECT_NEAR(where.depth.at(11, 5, 0), kCardZ / other.cosine(6.5, 5.5, 64, 32), 1e-5)
      << "along its ray there";
  EXPECT_EQ(where.offset.at(12, 5, 0), kNowhere);
  EXPECT_EQ(where.depth.at(12, 5, 0), 0.0f);
  EXPECT_EQ(where.offset.at(13, 5, 0), kNowhere) << "further than the limit";
}

TEST(Disparity, OffsetsOfOneEyeTellThoseOfTheOther) {
  // Pixels 0 to 2 lead to 2 to 4; 3 and 4, which the other eye does not see, to 3 and outside; 5 to 7; 7 to 7
  // but for less than a pixel of difference.
  Image there(8, 1, 2), residual(8, 1, 1, 0.5f);
  const float offsets[] = {2.0f, 2.0f, 2.25f, 0.0f, 9.0f, 2.0f, 0.75f, 0.0f};
  for (int x = 0; x < 8; ++x) there.at(x, 0, 0) = offsets[x];
  residual.at(1, 0, 0) = 0.1f;
  residual.at(6, 0, 0) = 0.2f;
  const auto [own, other] = unique_offsets(there, residual);
  for (const int x : {0, 1, 2, 6, 7}) EXPECT_EQ(own.at(x, 0, 0), offsets[x]) << x;
  EXPECT_EQ(own.at(3, 0, 0), kNowhere) << "pixel 1 matches better there";
  EXPECT_EQ(own.at(4, 0, 0), kNowhere) << "outside of the image";
  EXPECT_EQ(own.at(5, 0, 0), kNowhere) << "pixel 6 matches better there";
  const float back[] = {kNowhere, -2.0f, -2.0f, -2.0f, -2.25f, -2.25f, -0.75f, -0.75f};
  for (int x = 0; x < 8; ++x) EXPECT_EQ(other.at(x, 0, 0), back[x]) << x;
}

}  // namespace
}  // namespace becalm::filter::stereo_test
