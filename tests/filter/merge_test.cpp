#include "filter/merge/merge.h"

#include <functional>
#include <random>

#include "filter/input/noisy_inputs.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/merge.h"
#include "tests/filter/task.h"

namespace becalm::filter::merge_test {
namespace {

using reference::Estimate;
using reference::Grid;
using reference::Rgba;
using reference::Vec2;

constexpr int kWidth = 61;
constexpr int kHeight = 43;
constexpr gpu::Extent kFull{kWidth, kHeight};
constexpr double kExposure = 1.7;

/// The balanced preset for frames that are not smoothed: the patches are large enough to distinguish bias
/// from noise.
Settings of_noisy_frames() {
  Settings settings = preset("balanced");
  settings.smooth = Smooth::none;
  settings.patch_radius = 3;
  return settings;
}

/// For chains of the merge's passes alone: smooth=merged reads the noisy frame, but carries no layers of it.
Settings without_noisy_layers(Settings settings) {
  if (settings.smooth == Smooth::merged) settings.smooth = Smooth::none;
  return settings;
}

/// A chain with only the merge's passes; offsets and residuals are inputs.
class MergeOnDevice {
 public:
  MergeOnDevice(gpu::Device& device, const Settings& settings)
      : chain_(device, "merge test"),
        noisy_(chain_, task_with_variance(without_noisy_layers(settings), kFull), kFull, NoisyUse::merge) {
    const gpu::Extent full = kFull;
    const bool smoothed = settings.smooth != Smooth::none;
    color_ = smoothed ? chain_.input("smoothed.color", gpu::Format::f32x4, full) : noisy_.color;
    variance_ = smoothed ? chain_.input("smoothed.stats", gpu::Format::f32x2, full) : noisy_.variance;
    alignment_.offset = chain_.input("offset", gpu::Format::f32x2, full);
    if (settings.merge == MergeMode::mask) {
      alignment_.residual = chain_.input("residual.L0", gpu::Format::f32, full);
    }
    const gpu::History color = chain_.history("history.color", gpu::Format::f32x4, full);
    const gpu::History stats = chain_.history("history.stats", gpu::Format::f32x2, full);
    decision_ = add_merge_passes(chain_, settings, full,
                                 {.noisy = noisy_,
                                  .color = color_,
                                  .variance = variance_,
                                  .history_color = color,
                                  .history_stats = stats},
                                 alignment_)
                    .decision;
    merged_color_ = color.next;
    merged_stats_ = stats.next;
    chain_.output(merged_color_);
    chain_.output(merged_stats_);
    chain_.output(decision_);
    chain_.build();
  }

  reference::Merged run(const Grid<Estimate>& sample, const Grid<Vec2>& offset,
                        const Grid<double>* residual = nullptr, const Grid<Estimate>* noisy = nullptr) {
    upload_estimate(chain_, color_, variance_, sample);
    if (noisy) upload_estimate(chain_, noisy_.color, noisy_.variance, *noisy);
    upload_offset(chain_, alignment_.offset, offset);
    chain_.upload<float>(noisy_.exposure)[0] = kExposure;
    if (residual) std::ranges::copy(residual->data, chain_.upload<float>(alignment_.residual).begin());
    chain_.run();
    reference::Merged merged{download_estimate(chain_, merged_color_, merged_stats_, kFull),
                             Grid<double>(kWidth, kHeight)};
    const auto decision = chain_.download<float>(decision_);
    for (std::size_t i = 0; i < merged.rejected.data.size(); ++i) merged.rejected.data[i] = decision[4 * i];
    return merged;
  }

 private:
  gpu::Chain chain_;
  NoisyInputs noisy_;
  gpu::ImageId color_, variance_;  ///< of the new frame, smoothed or not
  gpu::ImageId merged_color_, merged_stats_, decision_;
  Alignment alignment_;
};

/// Noisy samples of a shaded pattern whose noise grows with its value, every value a float.
Grid<Estimate> noisy_sample(unsigned seed, double brightness = 1.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  Grid<Estimate> sample(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Estimate& e = sample.at(x, y);
      const double value = brightness * (0.05 + pattern(x, y, 4));
      const double sigma = 0.2 * value;
      for (int c = 0; c < 3; ++c)
        e.color[c] = static_cast<float>(value * (1.0 + 0.3 * c) + sigma * noise(random));
      e.color[3] = 1.0;
      e.variance = static_cast<float>(sigma * sigma);
      e.count = 1.0;
    }
  }
  return sample;
}

/// The noisy frame whose smoothed one is `sample`: its variance is from none to much more than the error
/// left.
Grid<Estimate> before_smoothing(Grid<Estimate> sample) {
  constexpr std::array kOfError{0.0, 0.5, 1.0, 4.0, 30.0};
  for (std::size_t i = 0; i < sample.data.size(); ++i) {
    const double noisy = kOfError[i / 7 % kOfError.size()] * sample.data[i].variance;
    sample.data[i].variance = static_cast<float>(noisy);
  }
  return sample;
}

Grid<Vec2> wavy_offset() {
  Grid<Vec2> offset(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      // The offsets lead beyond the image at two borders, and some are integers.
      offset.at(x, y) = x < 20 ? Vec2{-2.0, 1.0}
                               : Vec2{static_cast<float>(2.0 * std::sin(0.2 * y)),
                                      static_cast<float>(1.5 * std::cos(0.3 * x))};
    }
  }
  return offset;
}

class MergeTest : public DeviceTest {};

void expect_agreement(const reference::Merged& found, const reference::Merged& truth, int frame) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Estimate& f = found.estimate.at(x, y);
      const Estimate& t = truth.estimate.at(x, y);
      for (int c = 0; c < 4; ++c) {
        ASSERT_NEAR(f.color[c], t.color[c], 1e-3 * std::abs(t.color[c]) + 1e-6)
            << "frame " << frame << " pixel " << x << "," << y << " channel " << c;
      }
      ASSERT_NEAR(f.count, t.count, 1e-3 * t.count) << "frame " << frame << " pixel " << x << "," << y;
      ASSERT_NEAR(f.variance, t.variance, 5e-3 * t.variance + 1e-9)  // 1 - alpha is rounded
          << "frame " << frame << " pixel " << x << "," << y;
      ASSERT_NEAR(found.rejected.at(x, y), truth.rejected.at(x, y), 2e-3)
          << "frame " << frame << " pixel " << x << "," << y;
    }
  }
}

class VarianceGainTest : public MergeTest, public testing::WithParamInterface<Smooth> {};
INSTANTIATE_TEST_SUITE_P(Smooth, VarianceGainTest,
                         testing::Values(Smooth::none, Smooth::frames, Smooth::merged));

TEST_P(VarianceGainTest, AgreesWithTheReference) {
  Settings settings = of_noisy_frames();
  settings.smooth = GetParam();
  MergeOnDevice merge(device(), settings);
  Grid<Estimate> history(kWidth, kHeight);
  const Grid<Vec2> offset = wavy_offset();
  for (int frame = 0; frame < 5; ++frame) {
    Grid<Estimate> sample = noisy_sample(frame, frame == 3 ? 1.5 : 1.0);
    sample.at(30, 20).count = 0.0;                                          // a pixel that was not finite
    for (int x = 0; x < kWidth; x += 3) sample.at(x, 11).variance *= 1e-4;  // a lower variance than its patch
    if (settings.smooth == Smooth::none) {  // a pixel of the sun, which smoothing would have dimmed
      for (double& c : sample.at(39, 24).color) c *= 300;
      sample.at(39, 24).variance *= 1e7;
    }
    const Grid<Estimate> noisy = before_smoothing(sample);
    const reference::Merged found =
        merge.run(sample, offset, nullptr, settings.smooth == Smooth::merged ? &noisy : nullptr);
    const reference::Merged truth = reference::merge_by_variance(
        sample, reference::warp(history, offset, settings.resample), kExposure, settings, noisy);
    expect_agreement(found, truth, frame);
    history = found.estimate;  // both continue from the same floats
  }
}

TEST_F(MergeTest, ALoneDarkPixelRejectsItsHistoryAndABrightOneDoesNot) {
  Settings settings = of_noisy_frames();
  settings.smooth = Smooth::frames;
  MergeOnDevice merge(device(), settings);
  Grid<Estimate> sample(kWidth, kHeight);
  for (Estimate& e : sample.data) e = {.color = {1, 1, 1, 1}, .variance = 1e-4, .count = 1.0};
  const Grid<Vec2> still(kWidth, kHeight);
  merge.run(sample, still);
  sample.at(12, 20).color = {0.1, 0.1, 0.1, 1};
  sample.at(40, 20).color = {1.9, 1.9, 1.9, 1};
  const reference::Merged found = merge.run(sample, still);
  EXPECT_GT(found.rejected.at(12, 20), 0.95);
  EXPECT_EQ(found.rejected.at(40, 20), 0.0);
}

TEST_F(MergeTest, AFireflyHasNoPartInItsOwnWeight) {
  const Settings settings = of_noisy_frames();
  MergeOnDevice merge(device(), settings);
  const Grid<Vec2> still(kWidth, kHeight);
  const Grid<Estimate> history = merge.run(noisy_sample(1), still).estimate;
  Grid<Estimate> sample = noisy_sample(2);
  Estimate& firefly = sample.at(12, 30);
  firefly.color = {2e5, 2e5, 2e5, 1.0};
  firefly.variance = 1e10;
  const Estimate found = merge.run(sample, still).estimate.at(12, 30);
  const Estimate truth =
      reference::merge_by_variance(sample, history, kExposure, settings).estimate.at(12, 30);
  EXPECT_NEAR(found.color[0], truth.color[0], 1e-4 * truth.color[0]);
  EXPECT_NEAR(found.count, truth.count, 1e-4 * truth.count);
  EXPECT_GT(found.count, 1.8) << "its neighbours agree with their history";
}

TEST_F(MergeTest, MaskGainAgreesWithTheReference) {
  Settings settings = of_noisy_frames();
  settings.merge = MergeMode::mask;
  settings.match_downsample = 1;  // the residual is given at full resolution
  MergeOnDevice merge(device(), settings);
  Grid<Estimate> history(kWidth, kHeight);
  const Grid<Vec2> offset = wavy_offset();
  Grid<double> residual(kWidth, kHeight);
  for (std::size_t i = 0; i < residual.data.size(); ++i)
    residual.data[i] = static_cast<float>((i % 40) * 0.05);
  for (int frame = 0; frame < 5; ++frame) {
    const Grid<Estimate> sample = noisy_sample(frame);
    const reference::Merged found = merge.run(sample, offset, &residual);
    expect_agreement(
        found,
        reference::merge_by_mask(sample, reference::warp(history, offset, settings.resample), residual),
        frame);
    history = found.estimate;
  }
}

/// On a static scene with known noise, both modes must give the exact running mean of all samples.
void expect_running_mean(gpu::Device& device, const Settings& settings, int frames) {
  MergeOnDevice merge(device, settings);
  const Grid<Vec2> still(kWidth, kHeight);
  const Grid<double> perfect(kWidth, kHeight);
  Grid<Rgba> sum(kWidth, kHeight);
  reference::Merged merged;
  for (int frame = 0; frame < frames; ++frame) {
    Grid<Estimate> sample = noisy_sample(100 + frame);
    // With equal noise everywhere, the weights are those of eq. 6.
    for (Estimate& e : sample.data) e.variance = 0.04;
    for (std::size_t i = 0; i < sum.data.size(); ++i) {
      for (int c = 0; c < 4; ++c) sum.data[i][c] += sample.data[i].color[c];
    }
    merged = merge.run(sample, still, settings.merge == MergeMode::mask ? &perfect : nullptr);
  }
  for (std::size_t i = 0; i < sum.data.size(); ++i) {
    ASSERT_NEAR(merged.estimate.data[i].count, frames, 1e-3 * frames) << "pixel " << i;
    for (int c = 0; c < 4; ++c) {
      const double mean = sum.data[i][c] / frames;
      ASSERT_NEAR(merged.estimate.data[i].color[c], mean, 1e-5 * std::abs(mean) + 1e-6) << "pixel " << i;
    }
  }
}

TEST_F(MergeTest, VarianceModeConvergesToTheRunningMean) {
  expect_running_mean(device(), of_noisy_frames(), 24);
}

TEST_F(MergeTest, MaskModeConvergesToTheRunningMean) {
  Settings settings = of_noisy_frames();
  settings.merge = MergeMode::mask;
  expect_running_mean(device(), settings, 10);  // the history never weighs more than nine frames
}

TEST_F(MergeTest, AnUnrelatedImageIsRejectedEverywhere) {
  MergeOnDevice merge(device(), of_noisy_frames());
  const Grid<Vec2> still(kWidth, kHeight);
  const auto unrelated = [](unsigned seed) {
    Grid<Estimate> sample(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double value = 0.05 + pattern(3.0 * x, 3.0 * y, seed);
        sample.at(x, y) = {{value, value, value, 1.0}, 1e-6, 1.0};
      }
    }
    return sample;
  };
  for (int frame = 0; frame < 4; ++frame) merge.run(unrelated(1), still);
  const Grid<Estimate> other = unrelated(77);
  const reference::Merged merged = merge.run(other, still);
  for (std::size_t i = 0; i < merged.rejected.data.size(); ++i) {
    EXPECT_GT(merged.rejected.data[i], 0.99) << "pixel " << i;
    EXPECT_NEAR(merged.estimate.data[i].color[0], other.data[i].color[0], 0.01) << "pixel " << i;
  }
}

}  // namespace
}  // namespace becalm::filter::merge_test
