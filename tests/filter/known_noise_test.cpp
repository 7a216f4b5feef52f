// The variance of a carried noisy layer: lowered to the noise that differs from frame to frame.
#include <cmath>
#include <random>

#include "filter/input/noisy_inputs.h"
#include "filter/merge/merge.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/merge.h"
#include "tests/filter/task.h"

namespace becalm::filter::known_noise_test {
namespace {

using reference::Estimate;
using reference::Grid;

constexpr int kWidth = 61;
constexpr int kHeight = 43;
constexpr gpu::Extent kFull{kWidth, kHeight};
constexpr double kExposure = 1.7;
constexpr double kDeviation = 0.1;

Settings settings_of_merge() {
  Settings settings = preset("balanced");
  settings.smooth = Smooth::none;
  settings.patch_radius = 3;
  return settings;
}

/// A chain that merges a noisy frame, and the frame as a layer of its own with the variance in alpha. Nothing
/// moves.
class CarriedNoise {
 public:
  explicit CarriedNoise(gpu::Device& device)
      : chain_(device, "known noise test"),
        noisy_(chain_, task_with_variance(settings_of_merge(), kFull), kFull, NoisyUse::merge) {
    layer_ = chain_.input("layer", gpu::Format::f32x4, kFull);
    offset_ = chain_.input("offset", gpu::Format::f32x2, kFull);
    const gpu::History color = chain_.history("history.color", gpu::Format::f32x4, kFull);
    const gpu::History stats = chain_.history("history.stats", gpu::Format::f32x2, kFull);
    const gpu::History carried = chain_.history("history.layer", gpu::Format::f32x4, kFull);
    decision_ =
        add_merge_passes(chain_, settings_of_merge(), kFull,
                         {.noisy = noisy_,
                          .color = noisy_.color,
                          .variance = noisy_.variance,
                          .history_color = color,
                          .history_stats = stats,
                          .carried = {{.color = layer_, .history = carried, .kind = Carried::radiance}}},
                         {.offset = offset_, .residual = {}})
            .decision;
    stats_ = stats.next;
    carried_ = carried.next;
    for (const gpu::ImageId image : {stats_, carried_, decision_}) chain_.output(image);
    chain_.build();
  }

  /// The layer that is carried on: its radiance, its variance, and the history's effective sample count.
  Grid<Estimate> run(const Grid<Estimate>& sample) {
    upload_estimate(chain_, noisy_.color, noisy_.variance, sample);
    Grid<Estimate> layer = sample;
    for (Estimate& e : layer.data) e.color[3] = e.variance;
    upload_estimate(chain_, layer_, noisy_.variance, layer);
    std::ranges::fill(chain_.upload<float>(offset_), 0.0f);
    chain_.upload<float>(noisy_.exposure)[0] = kExposure;
    chain_.run();
    Grid<Estimate> carried = download_estimate(chain_, carried_, stats_, kFull);
    for (Estimate& e : carried.data) e.variance = e.color[3];
    return carried;
  }
  /// The last frame's weight in what is carried.
  double weight(std::size_t pixel) const { return chain_.download<float>(decision_)[4 * pixel + 2]; }

 private:
  gpu::Chain chain_;
  NoisyInputs noisy_;
  gpu::ImageId layer_, offset_, decision_, stats_, carried_;
};

/// A pattern under noise of known variance: one image for each seed.
Grid<Estimate> noisy_sample(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kDeviation);
  Grid<Estimate> sample(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto value = static_cast<float>(0.5 + pattern(x, y, 4) + noise(random));
      sample.at(x, y) = {{value, value, value, 1.0}, static_cast<float>(kDeviation * kDeviation), 1.0};
    }
  }
  return sample;
}

double mean_variance(const Grid<Estimate>& layer) {
  double sum = 0;
  for (const Estimate& e : layer.data) sum += e.variance / (kWidth * kHeight);
  return sum;
}

class KnownNoiseTest : public DeviceTest {};

TEST_F(KnownNoiseTest, AgreesWithTheReference) {
  CarriedNoise merge(device());
  Grid<Estimate> history(kWidth, kHeight);
  int lowered = 0;
  for (int frame = 0; frame < 5; ++frame) {
    Grid<Estimate> sample = noisy_sample(frame);
    const Grid<Estimate> repeated = noisy_sample(100);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth / 2; ++x) sample.at(x, y) = repeated.at(x, y);
    }
    for (Estimate& e : sample.data) e.variance *= frame % 2 == 0 ? 2.0 : 1.0;
    sample.at(30, 20).count = 0.0;  // a pixel that was not finite
    sample.at(12, 30).color = {50.0, 50.0, 50.0, 1.0};
    sample.at(12, 30).variance = 2000.0;
    const Grid<Estimate> known = reference::known_noise(sample, history, kExposure);
    const Grid<Estimate> carried = merge.run(sample);
    for (std::size_t i = 0; i < known.data.size(); ++i) {
      const double before = history.data[i].variance;
      const double weight = merge.weight(i);
      const double expected = history.data[i].count > 0 && weight < 1.0
                                  ? before + weight * (known.data[i].variance - before)
                                  : known.data[i].variance;
      ASSERT_NEAR(carried.data[i].variance, expected, 5e-5 * expected + 1e-9)
          << "frame " << frame << " pixel " << i;
      lowered += known.data[i].variance < 0.9 * sample.data[i].variance;
    }
    history = carried;  // both continue from the same floats
  }
  EXPECT_GT(lowered, 2000);
}

TEST_F(KnownNoiseTest, WhatRepeatsIsNoNoise) {
  CarriedNoise merge(device());
  Grid<Estimate> carried;
  for (int frame = 0; frame < 8; ++frame) carried = merge.run(noisy_sample(1));
  // The first frame has nothing to be compared with.
  EXPECT_NEAR(mean_variance(carried), kDeviation * kDeviation / 8, 0.02 * kDeviation * kDeviation);
}

TEST_F(KnownNoiseTest, NoiseThatDiffersStays) {
  CarriedNoise merge(device());
  Grid<Estimate> carried;
  for (int frame = 0; frame < 8; ++frame) carried = merge.run(noisy_sample(frame));
  EXPECT_NEAR(mean_variance(carried) / (kDeviation * kDeviation), 1.0, 0.15);
}

TEST_F(KnownNoiseTest, AFireflyAmongCalmPixelsKeepsItsVariance) {
  CarriedNoise merge(device());
  Grid<Estimate> before;
  for (int frame = 0; frame < 3; ++frame) before = merge.run(noisy_sample(1));
  Grid<Estimate> sample = noisy_sample(1);
  sample.at(20, 15).color = {100.0, 100.0, 100.0, 1.0};
  sample.at(20, 15).variance = 1e4;
  const double carried = merge.run(sample).at(20, 15).variance;
  const double weight = merge.weight(15 * kWidth + 20);
  // The squared difference from a mean of three frames is 4/3 of a frame's variance.
  EXPECT_GT(carried, 0.7 * weight * 1e4);
}

}  // namespace
}  // namespace becalm::filter::known_noise_test
