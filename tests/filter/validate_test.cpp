// The history validated against the new frame, alone and on its way into the merge.
#include "filter/validate.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "filter/host_images.h"
#include "filter/noisy_inputs.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/validate.h"
#include "tests/filter/task.h"

namespace becalm::filter {
namespace {

using reference::Estimate;
using reference::Grid;
using reference::Surface;
using reference::Vec2;

constexpr int kWidth = 45;
constexpr int kHeight = 33;
constexpr gpu::Extent kFull{kWidth, kHeight};
constexpr double kBrightness = 1.1;  // of radiance 1 at an exposure of 1

/// The final preset with neither validation nor luminance weights, for frames that are noisy themselves.
Settings of_noisy_frames() {
  Settings settings = preset("final");
  settings.smooth = Smooth::none;
  settings.validate = 0;
  settings.restore_energy = 0;
  settings.luminance_weight = 0.0f;
  settings.patch_radius = 3;
  settings.significance = 3.0f;
  return settings;
}

AovSet surface_aovs() {
  AovSet set;
  for (const Aov aov : {Aov::depth, Aov::normal, Aov::object_id}) set.set(static_cast<std::size_t>(aov));
  return set;
}

/// A slanted floor before nothing, with a ball of another number in front of it, moved by `shift` px.
Grid<Surface> scene(double shift) {
  Grid<Surface> grid(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Surface& s = grid.at(x, y);
      const double u = (x + shift - 22) / 11.0;
      const double v = (y - 18) / 11.0;
      if (u * u + v * v < 1) {
        const double w = std::sqrt(1 - u * u - v * v);
        s = {5 - w, {u, v, w}, 2};
      } else if (y > 12) {
        s = {60.0 / (y - 10), {0, 0.6, -0.8}, 1};
      } else {
        s = {std::numeric_limits<double>::infinity(), {}, 0};
      }
    }
  }
  return grid;
}

Frame frame_of(const Grid<Surface>& surfaces) {
  Frame frame(1, kWidth, kHeight);
  Image& depth = frame.add(Aov::depth);
  Image& normal = frame.add(Aov::normal);
  Image& id = frame.add(Aov::object_id);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Surface& s = surfaces.at(x, y);
      depth.at(x, y, 0) = static_cast<float>(s.depth);
      id.at(x, y, 0) = static_cast<float>(s.id);
      for (int c = 0; c < 3; ++c) normal.at(x, y, c) = static_cast<float>(s.normal[c]);
    }
  }
  return frame;
}

Grid<Vec2> steady_offset(double x, double y) {
  return {kWidth, kHeight, {x, y}};
}

/// The merge of one frame with one history, given all that it reads.
class MergeOnDevice {
 public:
  MergeOnDevice(gpu::Device& device, const Settings& settings)
      : chain_(device, "validate test"),
        noisy_(chain_, task_with_variance(settings, kFull), kFull, NoisyUse::merge),
        rules_(applicable_rules(settings, surface_aovs())) {
    offset_ = chain_.input("offset", gpu::Format::f32x2, kFull);
    history_color_ = {chain_.input("history.color", gpu::Format::f32x4, kFull),
                      chain_.image("merged.color", gpu::Format::f32x4, kFull)};
    history_stats_ = {chain_.input("history.stats", gpu::Format::f32x2, kFull),
                      chain_.image("merged.stats", gpu::Format::f32x2, kFull)};
    if (rules_ & kValidateBySurface) {
      surface_ = {chain_.input("surface.cur", gpu::Format::f32x4, kFull),
                  chain_.input("surface.prev", gpu::Format::f32x4, kFull)};
    }
    Alignment alignment{.offset = offset_, .residual = {}};
    if (rules_ & validate_flow) {
      alignment.consistency = consistency_ = chain_.input("consistency", gpu::Format::f32, kFull);
    }
    for (std::size_t l = 0; l < pyramid_extents(settings, kWidth, kHeight).size(); ++l) {
      alignment.residual.push_back(chain_.image("residual." + std::to_string(l), gpu::Format::f32, {1, 1}));
    }
    if (settings.merge == MergeMode::mask) {
      residual_ = chain_.input("residual", gpu::Format::f32, level_extent(settings, kFull, 0));
      alignment.residual.front() = *residual_;
    }
    decision_ = add_merge_passes(chain_, settings, kFull,
                                 {.noisy = noisy_,
                                  .color = noisy_.color,
                                  .variance = noisy_.variance,
                                  .history_color = history_color_,
                                  .history_stats = history_stats_,
                                  .rules = rules_,
                                  .surface = surface_},
                                 alignment)
                    .decision;
    for (const gpu::ImageId image : {history_color_.next, history_stats_.next, decision_}) {
      chain_.output(image);
    }
    chain_.build();
  }

  struct Result {
    Grid<Estimate> merged;
    Grid<double> rejected, gain, rule;
  };

  Result run(const Grid<Estimate>& sample, const Grid<Estimate>& history, const Grid<Vec2>& offset,
             const Grid<Surface>& now, const Grid<Surface>& before, const Grid<double>& consistency = {}) {
    upload_estimate(chain_, noisy_.color, noisy_.variance, sample);
    upload_estimate(chain_, history_color_.previous, history_stats_.previous, history);
    upload_offset(chain_, offset_, offset);
    chain_.upload<float>(noisy_.exposure)[0] = 1.0f;
    if (residual_) std::ranges::fill(chain_.upload<float>(*residual_), 0.0f);
    if (consistency_) std::ranges::copy(consistency.data, chain_.upload<float>(*consistency_).begin());
    if (rules_ & kValidateBySurface) {
      for (const auto& [surfaces, image] :
           {std::pair{&now, surface_.current}, {&before, surface_.previous}}) {
        pack_surface(frame_of(*surfaces), surface_aovs(), bounds(kFull), chain_.upload<float>(image));
      }
    }
    chain_.run();
    Result result{download_estimate(chain_, history_color_.next, history_stats_.next, kFull),
                  Grid<double>(kWidth, kHeight), Grid<double>(kWidth, kHeight),
                  Grid<double>(kWidth, kHeight)};
    const auto decision = chain_.download<float>(decision_);
    for (std::size_t i = 0; i < result.merged.data.size(); ++i) {
      result.rejected.data[i] = decision[4 * i];
      result.gain.data[i] = decision[4 * i + 2];
      result.rule.data[i] = decision[4 * i + 3];
    }
    return result;
  }

 private:
  gpu::Chain chain_;
  NoisyInputs noisy_;
  unsigned rules_;
  gpu::History history_color_, history_stats_;
  FramePair surface_{};
  std::optional<gpu::ImageId> residual_, consistency_;
  gpu::ImageId offset_, decision_;
};

/// Noise around a pattern.
Grid<Estimate> noisy(unsigned seed, double variance, double count, double brightness = 1.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  Grid<Estimate> grid(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Estimate& e = grid.at(x, y);
      for (int c = 0; c < 3; ++c) {
        e.color[c] = static_cast<float>(brightness *
                                        (0.3 + pattern(x, y, 3 + c) + std::sqrt(variance) * noise(random)));
      }
      e.color[3] = 1.0;
      e.variance = static_cast<float>(variance);
      e.count = count;
    }
  }
  return grid;
}

/// An even surface of radiance 1 and relative variance `variance`.
Grid<Estimate> even(double variance, double count) {
  return {kWidth, kHeight, {{1, 1, 1, 1}, variance * kBrightness * kBrightness, count}};
}

class ValidateTest : public DeviceTest {};

TEST_F(ValidateTest, TakesFromTheHistorysWeightWhatTheReferenceSays) {
  const Grid<Surface> before = scene(0);
  const Grid<Surface> now = scene(3);
  for (const char* merge : {"merge=variance", "merge=mask"}) {
    for (const char* rules :
         {"validate=depth", "validate=normal", "validate=id", "validate=depth,normal,id"}) {
      for (const Vec2 shift : {Vec2{0, 0}, {2.625, -0.375}}) {
        Settings settings = of_noisy_frames();
        set(settings, merge);
        set(settings, rules);
        settings.mask_alpha = 1.0f;
        settings.validate_bias = 0.5f;
        const Grid<Vec2> offset = steady_offset(shift.x, shift.y);
        const auto found =
            MergeOnDevice(device(), settings).run(even(0.04, 1), even(0.01, 4), offset, now, before);
        const Grid<double> truth = reference::trust(now, before, offset, settings);
        double least = 1;
        for (int y = 1; y < kHeight; ++y) {
          for (int x = 0; x < kWidth - 3; ++x) {  // beyond there is no history
            const double t = truth.at(x, y);
            const double distrusted = 0.01 + 0.25 * (1 - t);
            const double weight = settings.merge == MergeMode::mask ? 0.8 * t : 0.04 / (0.04 + distrusted);
            ASSERT_NEAR(1 - found.gain.at(x, y), weight, 2e-3)
                << merge << ' ' << rules << ' ' << x << ',' << y;
            least = std::min(least, t);
          }
        }
        EXPECT_LT(least, 0.5) << rules << ": nothing was there to be distrusted";
      }
    }
  }
}

TEST_F(ValidateTest, OffsetsThereAndBackThatDisagreeAreBias) {
  const Grid<Surface> still(kWidth, kHeight, {1, {0, 0, 1}, 1});
  Grid<Surface> before = still;
  Grid<double> consistency(kWidth, kHeight, 1.0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) consistency.at(x, y) = 1.0 / (1 + x % 7);
    before.at(14, y).id = 7;
  }
  for (const char* merge : {"merge=variance", "merge=mask"}) {
    for (const char* rules : {"validate=flow", "validate=id,flow"}) {
      Settings settings = of_noisy_frames();
      set(settings, merge);
      set(settings, rules);
      settings.mask_alpha = 1.0f;
      settings.validate_bias = 0.5f;
      const auto found =
          MergeOnDevice(device(), settings)
              .run(even(0.04, 1), even(0.01, 4), steady_offset(0, 0), still, before, consistency);
      for (int x = 0; x < kWidth; ++x) {
        const bool other_surface = x == 14 && settings.validate & validate_id;
        const double t = other_surface ? 0.0 : consistency.at(x, 9);
        const double weight = settings.merge == MergeMode::mask ? 0.8 * t : 0.04 / (0.05 + 0.25 * (1 - t));
        ASSERT_NEAR(1 - found.gain.at(x, 9), weight, 2e-3) << merge << ' ' << rules << ' ' << x;
        EXPECT_EQ(found.rule.at(x, 9), other_surface ? 5.0 : t < 1 ? 6.0 : 0.0) << merge << ' ' << x;
      }
    }
  }
}

TEST_F(ValidateTest, DistrustIsPartOfTheVarianceThatIsLeft) {
  // Without bias the merged variance is a third of either; a history that is not believed leaves the
  // sample's.
  Settings settings = of_noisy_frames();
  set(settings, "validate=id");
  settings.validate_bias = 1000.0f;
  const Grid<Surface> now(kWidth, kHeight, {1, {0, 0, 1}, 1});
  Grid<Surface> before = now;
  for (int y = 0; y < kHeight; ++y) before.at(20, y).id = 7;
  const auto result = MergeOnDevice(device(), settings)
                          .run(noisy(1, 0.04, 1), noisy(2, 0.02, 2), steady_offset(0, 0), now, before);
  EXPECT_NEAR(result.merged.at(20, 15).variance, 0.04, 1e-4);
  EXPECT_NEAR(result.merged.at(20, 15).count, 1.0, 1e-3);
  EXPECT_EQ(result.rule.at(20, 15), 5.0);
  EXPECT_GT(result.rejected.at(20, 15), 0.999);
  EXPECT_NEAR(result.merged.at(10, 15).variance, 0.04 / 3, 2e-3);
  EXPECT_EQ(result.rule.at(10, 15), 0.0);
}

TEST_F(ValidateTest, AStaticSceneIsTrustedWholly) {
  Settings settings = of_noisy_frames();
  set(settings, "validate=depth,normal,id");
  const Grid<Surface> still = scene(0);
  const Grid<Estimate> sample = noisy(1, 0.04, 1);
  const Grid<Estimate> history = noisy(2, 0.01, 4);
  const Grid<Vec2> offset = steady_offset(0, 0);
  const auto validated = MergeOnDevice(device(), settings).run(sample, history, offset, still, still);
  set(settings, "validate=none");
  const auto plain = MergeOnDevice(device(), settings).run(sample, history, offset, still, still);
  for (std::size_t i = 0; i < plain.merged.data.size(); ++i) {
    ASSERT_EQ(validated.merged.data[i].color, plain.merged.data[i].color) << "pixel " << i;
  }
}

TEST_F(ValidateTest, RectificationAgreesWithTheReference) {
  Grid<Estimate> sample = noisy(1, 0.01, 1);
  sample.at(7, 8).count = 0;  // pixels that were not finite
  sample.at(8, 8).count = 0;
  const Grid<Estimate> history = noisy(2, 0.09, 5);
  for (const char* clip : {"history_clip=clamp", "history_clip=clip", "history_clip=variance"}) {
    for (const char* space : {"clip_space=rgb", "clip_space=ycocg"}) {
      for (const int radius : {1, 2}) {
        Settings settings = of_noisy_frames();
        set(settings, clip);
        set(settings, space);
        settings.clip_radius = radius;
        settings.clip_gamma = 1.25f;
        gpu::Chain chain(device(), "rectify test");
        const auto inputs = [&](const std::string& name) {
          return WarpedHistory{chain.input(name + ".color", gpu::Format::f32x4, kFull),
                               chain.input(name + ".stats", gpu::Format::f32x2, kFull)};
        };
        const WarpedHistory of_sample = inputs("sample");
        const WarpedHistory of_history = inputs("history");
        const WarpedHistory rectified =
            add_rectify_pass(chain, settings, kFull, of_sample.color, of_sample.stats, of_history);
        chain.output(rectified.color);
        chain.output(rectified.stats);
        chain.build();
        upload_estimate(chain, of_sample.color, of_sample.stats, sample);
        upload_estimate(chain, of_history.color, of_history.stats, history);
        chain.run();
        const Grid<Estimate> found = download_estimate(chain, rectified.color, rectified.stats, kFull);
        const Grid<Estimate> truth = reference::rectify(sample, history, settings);
        int moved = 0;
        for (std::size_t i = 0; i < truth.data.size(); ++i) {
          SCOPED_TRACE(testing::Message() << clip << ' ' << space << " radius " << radius << " pixel "
                                          << i % kWidth << ',' << i / kWidth);
          for (std::size_t c = 0; c < 4; ++c) {
            ASSERT_NEAR(found.data[i].color[c], truth.data[i].color[c], 1e-5);
          }
          ASSERT_NEAR(found.data[i].variance, truth.data[i].variance, 1e-5);
          ASSERT_NEAR(found.data[i].count, truth.data[i].count, 1e-3);
          moved += truth.data[i].color != history.data[i].color ? 1 : 0;
        }
        EXPECT_GT(moved, kWidth * kHeight / 10);
      }
    }
  }
}

TEST_F(ValidateTest, ExponentialAccumulationAlwaysGivesTheHistoryTheSameWeight) {
  Settings settings = of_noisy_frames();
  set(settings, "merge=mask");
  set(settings, "accumulate=exponential");
  const Grid<Surface> nothing(kWidth, kHeight);
  for (const double count : {1.0, 30.0}) {
    const auto result =
        MergeOnDevice(device(), settings)
            .run(noisy(1, 0.04, 1), noisy(2, 0.02, count), steady_offset(0, 0), nothing, nothing);
    EXPECT_NEAR(result.gain.at(20, 15), 0.1, 1e-6);
  }
  set(settings, "accumulate=count");
  const auto result = MergeOnDevice(device(), settings)
                          .run(noisy(1, 0.04, 1), noisy(2, 0.02, 1), steady_offset(0, 0), nothing, nothing);
  EXPECT_NEAR(result.gain.at(20, 15), 0.5, 1e-6);
}

TEST_F(ValidateTest, LuminanceWeightsBrightSamplesLessAsFarAsTheyAreNoisy) {
  // Eq. 4 of the survey: a sample of luminance 3 counts a quarter of a black history. That is for outliers:
  // of a difference that noise explains by half, half of it.
  Settings settings = of_noisy_frames();
  set(settings, "merge=mask");
  settings.luminance_weight = 1.0f;
  const Grid<Surface> nothing(kWidth, kHeight);
  const Grid<Estimate> black(kWidth, kHeight, {{0, 0, 0, 1}, 1.0, 1.0});
  const auto gain_of = [&](double variance) {
    const Grid<Estimate> bright(kWidth, kHeight, {{3, 3, 3, 1}, variance, 1.0});
    const auto result =
        MergeOnDevice(device(), settings).run(bright, black, steady_offset(0, 0), nothing, nothing);
    const double gain = result.gain.at(20, 15);
    EXPECT_NEAR(result.merged.at(20, 15).color[0], 3 * gain, 1e-5);
    return gain;
  };
  const double unweighted = 0.5;
  const double weighted = 0.25 / 1.25;
  EXPECT_NEAR(gain_of(1e12), weighted, 1e-6);
  EXPECT_NEAR(gain_of(9.0), 0.5 * (weighted + unweighted), 1e-6);
  EXPECT_NEAR(gain_of(0.0), unweighted, 1e-6);
}

}  // namespace
}  // namespace becalm::filter
