// The passes that combine both directions, against the formula in double.
#include "filter/merge/combine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/filter/device_fixture.h"

namespace becalm::filter::combine_test {
namespace {

constexpr int kWidth = 37;
constexpr int kHeight = 29;
constexpr double kExposure = 1.3;

struct Pixel {
  std::array<float, 4> color{};
  float variance = 0.0f;
  float count = 0.0f;
};
using Pixels = std::vector<Pixel>;

/// Run for estimates merged from noisy frames and from smoothed ones.
class CombineTest : public DeviceTest, public testing::WithParamInterface<Smooth> {
 protected:
  CombineTest() {
    settings_.smooth = GetParam();
    const gpu::Extent full{kWidth, kHeight};
    inputs_ = {.exposure = chain_.input("exposure", gpu::Format::f32, {1, 1}),
               .forward_color = chain_.input("forward.color", gpu::Format::f32x4, full),
               .forward_stats = chain_.input("forward.stats", gpu::Format::f32x2, full),
               .backward_color = chain_.input("backward.color", gpu::Format::f32x4, full),
               .backward_stats = chain_.input("backward.stats", gpu::Format::f32x2, full)};
    combined_ = add_combine_passes(chain_, settings_, full, inputs_);
    chain_.output(combined_.color);
    chain_.output(combined_.stats);
    chain_.build();
  }

  Pixels combine(const Pixels& forward, const Pixels& backward) {
    chain_.upload<float>(inputs_.exposure)[0] = kExposure;
    fill(forward, inputs_.forward_color, inputs_.forward_stats);
    fill(backward, inputs_.backward_color, inputs_.backward_stats);
    chain_.run();
    Pixels result(forward.size());
    const auto color = chain_.download<float>(combined_.color);
    const auto stats = chain_.download<float>(combined_.stats);
    for (std::size_t i = 0; i < result.size(); ++i) {
      std::copy_n(color.begin() + 4 * i, 4, result[i].color.begin());
      result[i].variance = stats[2 * i];
      result[i].count = stats[2 * i + 1];
    }
    return result;
  }

  void fill(const Pixels& pixels, gpu::ImageId color, gpu::ImageId stats) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      std::ranges::copy(pixels[i].color, chain_.upload<float>(color).begin() + 4 * i);
      chain_.upload<float>(stats)[2 * i] = pixels[i].variance;
      chain_.upload<float>(stats)[2 * i + 1] = pixels[i].count;
    }
  }

  Settings settings_;
  gpu::Chain chain_{device(), "combine test"};
  CombineInputs inputs_;
  Combined combined_;
};

Pixels random_pixels(unsigned seed, double holes = 0.0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit;
  Pixels pixels(kWidth * kHeight);
  for (Pixel& pixel : pixels) {
    for (float& v : pixel.color) v = 0.1f + unit(random);
    pixel.variance = 0.01f + unit(random);
    pixel.count = unit(random) < holes ? 0.0f : 1.0f + 10.0f * unit(random);
  }
  return pixels;
}

double weight_of_backward(const Pixels& f, const Pixels& b, int x, int y, const Settings& settings) {
  const int radius = settings.patch_radius;
  const auto variance_of_frame = [](const Pixel& p, double brightness) {
    return p.variance * p.count / (brightness * brightness);
  };
  double of_f = 0, of_b = 0, pixels = 0, own_f = 0, own_b = 0;
  for (int v = std::max(y - radius, 0); v <= std::min(y + radius, kHeight - 1); ++v) {
    for (int u = std::max(x - radius, 0); u <= std::min(x + radius, kWidth - 1); ++u) {
      const std::size_t i = v * kWidth + u;
      const bool own = u == x && v == y;
      if (f[i].count <= 0 || b[i].count <= 0) continue;
      const auto mean = [&](int c) { return 0.5 * (f[i].color[c] + b[i].color[c]); };
      const double brightness = 0.2126 * mean(0) + 0.7152 * mean(1) + 0.0722 * mean(2) + 0.1 / kExposure;
      (own ? own_f : of_f) += variance_of_frame(f[i], brightness);
      (own ? own_b : of_b) += variance_of_frame(b[i], brightness);
      pixels += own ? 0 : 1;
    }
  }
  const std::size_t i = y * kWidth + x;
  if (f[i].count <= 0) return b[i].count > 0 ? 1.0 : 0.0;
  if (b[i].count <= 0) return 0.0;
  if (settings.smooth != Smooth::none) {
    of_f = std::sqrt(of_f / pixels * std::max(own_f, 0.01 * of_f / pixels));
    of_b = std::sqrt(of_b / pixels * std::max(own_b, 0.01 * of_b / pixels));
  }
  of_f /= f[i].count;
  of_b /= b[i].count;
  return of_f / (of_f + of_b);
}

TEST_P(CombineTest, WeighsByTheInverseOfPatchVariances) {
  const Pixels f = random_pixels(1, 0.1);
  const Pixels b = random_pixels(2, 0.2);
  const Pixels found = combine(f, b);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t i = y * kWidth + x;
      const double w = weight_of_backward(f, b, x, y, settings_);
      for (int c = 0; c < 4; ++c) {
        ASSERT_NEAR(found[i].color[c], (1 - w) * f[i].color[c] + w * b[i].color[c], 1e-5) << x << "," << y;
      }
      ASSERT_NEAR(found[i].variance, (1 - w) * (1 - w) * f[i].variance + w * w * b[i].variance, 1e-5);
      const double inverse = (w < 1 ? (1 - w) * (1 - w) / f[i].count : 0) + (w > 0 ? w * w / b[i].count : 0);
      const double count = f[i].count <= 0 && b[i].count <= 0 ? 0 : 1 / inverse;
      ASSERT_NEAR(found[i].count, count, 1e-4 * std::max(count, 1.0)) << x << "," << y;
    }
  }
}

TEST_P(CombineTest, APixelsOwnVarianceWeighsItOnlyIfItIsThatOfAWindow) {
  const Pixels f = random_pixels(1);
  const Pixels b = random_pixels(2);
  Pixels outlier = f;
  const std::size_t middle = (kHeight / 2) * kWidth + kWidth / 2;
  outlier[middle].variance = 1e6f;
  const Pixel usual = combine(f, b)[middle];
  const Pixel found = combine(outlier, b)[middle];
  if (GetParam() == Smooth::none) {
    EXPECT_EQ(found.color, usual.color);
  } else {
    for (int c = 0; c < 4; ++c) {
      const float of_backward = b[middle].color[c];
      EXPECT_LT(std::abs(found.color[c] - of_backward),
                0.05f * std::abs(usual.color[c] - of_backward) + 1e-6f);
    }
  }
}

TEST_P(CombineTest, AnExactPixelAmongNoisyOnesDoesNotDecideAlone) {
  Pixels f = random_pixels(1);
  const Pixels b = random_pixels(2);
  const std::size_t middle = (kHeight / 2) * kWidth + kWidth / 2;
  f[middle].variance = 0.0f;
  f[middle].color = {};
  EXPECT_GT(combine(f, b)[middle].color[0], 0.02f * b[middle].color[0]);
}

TEST_P(CombineTest, WhatOnlyOneKnowsIsLeftAsItIs) {
  Pixels nothing(kWidth * kHeight);
  for (Pixel& pixel : nothing) pixel.color = {NAN, INFINITY, -1e30f, NAN};
  const Pixels f = random_pixels(1);
  for (const Pixels& found : {combine(f, nothing), combine(nothing, f)}) {
    for (std::size_t i = 0; i < f.size(); ++i) {
      ASSERT_EQ(found[i].color, f[i].color);
      ASSERT_EQ(found[i].variance, f[i].variance);
      ASSERT_EQ(found[i].count, f[i].count);
    }
  }
}

TEST_P(CombineTest, AHoleAmongExactPixelsIsFilledByTheOther) {
  Pixels forward = random_pixels(1);
  for (Pixel& pixel : forward) pixel.variance = 0.0f;
  Pixels backward = random_pixels(2);
  constexpr std::size_t hole = 9 * kWidth + 12, other_hole = 20 * kWidth + 30;
  forward[hole] = {.color = {NAN, INFINITY, -1e30f, NAN}};
  backward[other_hole] = forward[hole];
  const Pixels found = combine(forward, backward);
  EXPECT_EQ(found[hole].color, backward[hole].color);
  EXPECT_EQ(found[hole].count, backward[hole].count);
  EXPECT_EQ(found[other_hole].color, forward[other_hole].color);
}

TEST_P(CombineTest, ExactEstimatesGiveTheForwardOne) {
  Pixels f = random_pixels(1);
  Pixels b = random_pixels(2);
  for (Pixels* pixels : {&f, &b}) {
    for (Pixel& pixel : *pixels) pixel.variance = 0.0f;
  }
  const Pixels found = combine(f, b);
  for (std::size_t i = 0; i < f.size(); ++i) ASSERT_EQ(found[i].color, f[i].color);
}

INSTANTIATE_TEST_SUITE_P(Of, CombineTest, testing::Values(Smooth::none, Smooth::frames),
                         [](const auto& info) {
                           return info.param == Smooth::none ? "NoisyFrames" : "SmoothedFrames";
                         });

}  // namespace
}  // namespace becalm::filter::combine_test
