// The smoothing passes against the formulas in double.
#include "filter/smooth.h"

#include <algorithm>
#include <random>

#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/smooth.h"
#include "tests/filter/task.h"

namespace becalm::filter {
namespace {

using reference::Estimate;
using reference::Grid;

constexpr int kWidth = 27;
constexpr int kHeight = 21;
constexpr gpu::Extent kFull{kWidth, kHeight};
constexpr float kExposure = 1.7f;

struct Sample {
  Grid<Estimate> pixels{kWidth, kHeight};
  Grid<reference::SmoothFeatures> features{kWidth, kHeight};
};

/// A textured slope under noise before a wall of another normal, with fireflies and pixels that are not
/// finite.
Sample noisy_sample() {
  Sample sample;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.15);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool wall = y < 8 + x / 4;
      reference::SmoothFeatures& f = sample.features.at(x, y);
      for (int c = 0; c < 3; ++c) f[c] = static_cast<float>(pattern(2 * x, 2 * y, 4 + c));
      f[3] = static_cast<float>(wall ? 1.4 : 0.4 + 0.03 * y);
      f[wall ? 6 : 5] = 1.0;
      Estimate& e = sample.pixels.at(x, y);
      const double light = wall ? 0.5 : 1.0 + 0.05 * x;
      for (int c = 0; c < 3; ++c) {
        e.color[c] = static_cast<float>(light * (0.1 + f[c]) * (1 + noise(random)));
      }
      e.color[3] = 1.0;
      e.variance = static_cast<float>(std::pow(0.15 * light * 0.6, 2));
      if ((x * 7 + y * 11) % 97 == 0) {  // a sample in four that is thousands of times brighter
        for (int c = 0; c < 3; ++c) e.color[c] *= 3000;
        e.variance = static_cast<float>(std::pow(e.color[1], 2));
      }
      e.count = (x * 5 + y * 3) % 41 == 0 ? 0.0 : 1.0;
    }
  }
  return sample;
}

Grid<Estimate> smooth_on(gpu::Device& device, const Sample& sample, const Settings& settings) {
  gpu::Chain chain(device, "smooth test");
  const NoisyInputs noisy(chain, task_with_variance(settings, kFull), kFull, NoisyUse::smooth);
  const Smoothed smoothed = add_smooth_passes(chain, settings, kFull, noisy);
  chain.output(smoothed.color);
  chain.output(smoothed.stats);
  chain.build();
  chain.upload<float>(noisy.exposure)[0] = kExposure;
  upload_estimate(chain, noisy.color, noisy.variance, sample.pixels);
  for (std::size_t i = 0; i < sample.features.data.size(); ++i) {
    const reference::SmoothFeatures& f = sample.features.data[i];
    std::copy_n(f.begin(), 4, chain.upload<float>(noisy.features->albedo_depth).begin() + 4 * i);
    std::copy_n(f.begin() + 4, 3, chain.upload<float>(noisy.features->normal).begin() + 4 * i);
  }
  chain.run();
  return download_estimate(chain, smoothed.color, smoothed.stats, kFull);
}

class SmoothTest : public DeviceTest {};

TEST_F(SmoothTest, AgreesWithTheReference) {
  for (const auto& [radius, patch_radius, strength, surfaces] :
       {std::tuple{2, 1, 0.5f, 1.0f}, {3, 3, 0.5f, 0.0f}, {4, 2, 2.0f, 0.05f}, {3, 1, 2.0f, 20.0f}}) {
    SCOPED_TRACE(radius);
    Settings settings = preset("balanced");
    settings.smooth_radius = radius;
    settings.smooth_patch_radius = patch_radius;
    settings.smooth_strength = strength;
    settings.smooth_surfaces = surfaces;
    const Sample sample = noisy_sample();
    const Grid<Estimate> found = smooth_on(device(), sample, settings);
    const Grid<Estimate> truth = reference::smooth(sample.pixels, sample.features, kExposure, settings);
    double changed = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const Estimate& t = truth.at(x, y);
        for (int c = 0; c < 4; ++c) {
          // A weight that rounds the other way is off by a 255th of the pixel's own.
          ASSERT_NEAR(found.at(x, y).color[c], t.color[c], 2e-3 * std::abs(t.color[c]))
              << x << ',' << y << " channel " << c;
        }
        ASSERT_NEAR(found.at(x, y).variance, t.variance, 5e-3 * t.variance) << x << ',' << y;
        ASSERT_EQ(found.at(x, y).count, t.count) << x << ',' << y;
        const double before = sample.pixels.at(x, y).color[1];
        changed += std::abs(t.color[1] / before - 1) / (kWidth * kHeight);
      }
    }
    EXPECT_GT(changed, 0.03) << "there was hardly anything to smooth";
  }
}

}  // namespace
}  // namespace becalm::filter
