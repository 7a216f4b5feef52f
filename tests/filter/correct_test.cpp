// The correction of an estimate's means by the noisy frame.
#include "filter/correct.h"

#include <algorithm>
#include <limits>
#include <random>

#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/correct.h"

namespace becalm::filter {
namespace {

using reference::Estimate;
using reference::Grid;
using reference::Rgba;

constexpr float kExposure = 1.7f;

/// A frame and an estimate of it.
struct Pair {
  Pair(int width, int height) : frame(width, height), estimate(width, height), truth(width, height) {}

  Grid<Estimate> frame;
  Grid<Estimate> estimate;
  Grid<double> truth;
  Grid<Rgba> half_difference = {};  ///< empty unless there are half-buffers
};

/// A pattern under noise of a relative standard deviation of `noise`, and that pattern as its estimate.
Pair noisy_pattern(int width, int height, double noise, bool halves) {
  Pair pair(width, height);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, noise);
  if (halves) pair.half_difference = Grid<Rgba>(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = pair.truth.at(x, y) = static_cast<float>(0.2 + pattern(x, y, 4));
      Estimate& f = pair.frame.at(x, y);
      f = {{0, 0, 0, 1}, static_cast<float>(noise * noise * value * value), 1};
      pair.estimate.at(x, y) = {{value, value, value, 1}, 0, 4};
      for (int c = 0; c < 3; ++c) {
        f.color[c] = static_cast<float>(value * (1 + normal(random)));
        if (halves) pair.half_difference.at(x, y)[c] = static_cast<float>(value * normal(random));
      }
    }
  }
  return pair;
}

/// The correction's passes alone.
class CorrectOnDevice {
 public:
  CorrectOnDevice(gpu::Device& device, gpu::Extent full, bool halves, int levels,
                  Smooth smooth = Smooth::regression)
      : full_(full), chain_(device, "correct test") {
    inputs_ = {.color = chain_.input("color", gpu::Format::f32x4, full),
               .variance = chain_.input("variance", gpu::Format::f32x2, full),
               .exposure = chain_.input("exposure", gpu::Format::f32, {1, 1}),
               .half_difference = {},
               .estimate = chain_.input("estimate", gpu::Format::f32x4, full),
               .estimate_stats = chain_.input("estimate.stats", gpu::Format::f32x2, full)};
    if (halves) inputs_.half_difference = chain_.input("half_difference", gpu::Format::f32x4, full);
    Settings settings = preset("balanced");
    settings.correct_levels = levels;
    settings.smooth = smooth;
    corrected_ = add_correction_passes(chain_, settings, full, inputs_).estimate;
    chain_.output(corrected_);
    chain_.build();
  }

  Grid<Rgba> run(const Pair& pair, float exposure = kExposure) {
    upload_estimate(chain_, inputs_.color, inputs_.variance, pair.frame);
    upload_estimate(chain_, inputs_.estimate, inputs_.estimate_stats, pair.estimate);
    chain_.upload<float>(inputs_.exposure)[0] = exposure;
    for (std::size_t i = 0; i < pair.half_difference.data.size(); ++i) {
      std::ranges::copy(pair.half_difference.data[i],
                        chain_.upload<float>(*inputs_.half_difference).begin() + 4 * i);
    }
    chain_.run();
    Grid<Rgba> result(full_.width, full_.height);
    for (std::size_t i = 0; i < result.data.size(); ++i) {
      std::copy_n(chain_.download<float>(corrected_).begin() + 4 * i, 4, result.data[i].begin());
    }
    return result;
  }

 private:
  gpu::Extent full_;
  gpu::Chain chain_;
  CorrectionInputs inputs_;
  gpu::ImageId corrected_;
};

Grid<Rgba> correct_on(gpu::Device& device, const Pair& pair, int levels, Smooth smooth = Smooth::regression) {
  return CorrectOnDevice(device, {pair.frame.width, pair.frame.height}, !pair.half_difference.data.empty(),
                         levels, smooth)
      .run(pair);
}

/// Red of all pixels of a rectangle, over the truth's.
double relative_mean(const Grid<Rgba>& image, const Grid<double>& truth, int x0, int y0, int x1, int y1) {
  double sum = 0;
  double true_sum = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      sum += image.at(x, y)[0];
      true_sum += truth.at(x, y);
    }
  }
  return sum / true_sum;
}

class CorrectTest : public DeviceTest {};

TEST_F(CorrectTest, AgreesWithTheReference) {
  for (const bool halves : {false, true}) {
    Pair pair = noisy_pattern(41, 27, 0.2, halves);
    for (int y = 0; y < 27; ++y) {
      for (int x = 0; x < 41; ++x) {
        Estimate& e = pair.estimate.at(x, y);
        for (int c = 0; c < 3; ++c)
          e.color[c] = static_cast<float>(e.color[c] * (0.6 + pattern(x, y, 7 + c)));
        if ((x * 7 + y * 5) % 31 == 0) e.count = 0;
        if ((x * 3 + y * 11) % 37 == 0) pair.frame.at(x, y).count = 0;
      }
    }
    for (const auto& [levels, smooth] :
         {std::pair{1, Smooth::none}, {4, Smooth::none}, {4, Smooth::regression}, {6, Smooth::regression}}) {
      const Grid<Rgba> found = correct_on(device(), pair, levels, smooth);
      const Grid<Rgba> truth = reference::correct(pair.frame, pair.estimate, pair.half_difference, kExposure,
                                                  levels, smooth != Smooth::none);
      double changed = 0;
      for (std::size_t i = 0; i < truth.data.size(); ++i) {
        for (int c = 0; c < 4; ++c) {
          ASSERT_NEAR(found.data[i][c], truth.data[i][c], 1e-4 * std::abs(truth.data[i][c]))
              << levels << " levels, pixel " << i % 41 << ',' << i / 41 << " channel " << c;
        }
        changed += std::abs(truth.data[i][0] / pair.estimate.data[i].color[0] - 1) / (41 * 27);
      }
      EXPECT_GT(changed, 0.05) << "there was hardly anything to correct";
    }
  }
}

TEST_F(CorrectTest, LightThatIsMissingInARegionComesBack) {
  for (const bool halves : {false, true}) {
    Pair pair = noisy_pattern(64, 48, 0.2, halves);
    for (int y = 8; y < 40; ++y) {
      for (int x = 16; x < 48; ++x) {
        for (int c = 0; c < 3; ++c) pair.estimate.at(x, y).color[c] *= 0.9;
      }
    }
    const Grid<Rgba> corrected = correct_on(device(), pair, 4);
    // The frame's mean over 32x32 pixels has a standard error of 0.2 / 32.
    EXPECT_NEAR(relative_mean(corrected, pair.truth, 16, 8, 48, 40), 1.0, 0.025) << "halves " << halves;
    EXPECT_NEAR(relative_mean(corrected, pair.truth, 0, 0, 64, 48), 1.0, 0.01) << "halves " << halves;
  }
}

TEST_F(CorrectTest, NoiseOfTheFrameHardlyMovesAnExactEstimate) {
  for (const bool halves : {false, true}) {
    const Pair pair = noisy_pattern(64, 48, 0.2, halves);
    const Grid<Rgba> corrected = correct_on(device(), pair, 4);
    double squares = 0;
    for (std::size_t i = 0; i < corrected.data.size(); ++i) {
      const double relative = corrected.data[i][0] / pair.truth.data[i] - 1;
      squares += relative * relative / static_cast<double>(corrected.data.size());
    }
    EXPECT_LT(std::sqrt(squares), 0.2 / 5) << "halves " << halves;
    EXPECT_NEAR(relative_mean(corrected, pair.truth, 0, 0, 64, 48), 1.0, 0.01) << "halves " << halves;
  }
}

TEST_F(CorrectTest, WhatHasNoEstimateOrNoSampleStaysAndDecidesNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  Pair pair = noisy_pattern(29, 23, 0.2, true);
  for (Estimate& e : pair.estimate.data) e.count = 0;
  const Grid<Rgba> none = correct_on(device(), pair, 4);
  for (std::size_t i = 0; i < none.data.size(); ++i) ASSERT_EQ(none.data[i], pair.estimate.data[i].color);

  for (Estimate& e : pair.estimate.data) e.count = 4;
  pair.estimate.at(5, 6) = {{nan, nan, nan, nan}, nan, 0};
  pair.frame.at(20, 10) = {{inf, nan, -inf, 1}, inf, 0};
  const Grid<Rgba> corrected = correct_on(device(), pair, 4);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 29; ++x) {
      ASSERT_EQ(std::isfinite(corrected.at(x, y)[0]), x != 5 || y != 6) << x << ',' << y;
    }
  }
}

TEST_F(CorrectTest, BlackAndEnormousImagesOfAnySizeStayFinite) {
  const auto flat = [](int width, int height, double of_frame, double of_estimate, double variance) {
    Pair pair(width, height);
    for (Estimate& e : pair.frame.data) e = {{of_frame, of_frame, of_frame, 1}, variance, 1};
    for (Estimate& e : pair.estimate.data) e = {{of_estimate, of_estimate, of_estimate, 1}, 0, 4};
    return pair;
  };
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {64, 1}, {19, 3}}) {
    CorrectOnDevice correction(device(), {width, height}, false, 4);
    CorrectOnDevice by_halves(device(), {width, height}, true, 4);
    for (const Rgba& sides : {Rgba{0, 0}, {0, 1}, {1, 0}, {1e30, 1e30}, {1e30, 1}, {-2, 1}, {1e-30, 1e-30}}) {
      for (const auto& [variance, half_difference] :
           {std::pair{0.0, 0.0}, {1e34, 0.0}, {0.0, 1.0}, {0.0, 1e30}, {1e34, -3e38}}) {
        Pair pair = flat(width, height, sides[0], sides[1], variance);
        if (half_difference != 0) {
          pair.half_difference =
              Grid<Rgba>(width, height, {half_difference, half_difference, half_difference, 0});
        }
        const Grid<Rgba> corrected = (half_difference != 0 ? by_halves : correction).run(pair, 1.0f);
        for (const Rgba& pixel : corrected.data) {
          ASSERT_GE(pixel[0], 0.0) << width << 'x' << height << ": " << sides[0] << " and " << sides[1];
          ASSERT_LE(pixel[0], 32 * sides[1])
              << width << 'x' << height << ": " << sides[0] << " and " << sides[1];
          if (sides[0] == sides[1]) {
            ASSERT_EQ(pixel[0], static_cast<float>(sides[1])) << width << "x" << height;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace becalm::filter
