// What is estimated of a burst on the host: its noise, the motion of the whole picture, its sharpness.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <vector>

#include "filter/burst/global_motion.h"
#include "filter/burst/noise_fit.h"
#include "tests/filter/cfa_shots.h"

namespace becalm::filter {
namespace {

using namespace cfa_shots;
using reference::Vec2;

TEST(NoiseFit, FindsTheModel) {
  for (const CfaPattern& cfa : {bayer(0), x_trans()}) {
    for (const NoiseModel& noise : {NoiseModel{1e-5, 1e-7}, NoiseModel{3e-4, 2e-6}, NoiseModel{2e-3, 1e-4}}) {
      std::mt19937 random(3);
      std::normal_distribution<double> normal;
      Mosaic mosaic{Image(480, 480, 1), cfa};
      for (int y = 0; y < 480; ++y) {
        for (int x = 0; x < 480; ++x) {
          // Brightness rises along x; a third of the rows has texture.
          const double texture = y % 72 < 24 ? 0.05 * std::sin(1.1 * x) * std::sin(0.9 * y) : 0.0;
          const double light = 0.02 + 0.8 * x / 480.0 + texture;
          mosaic.samples.at(x, y, 0) =
              static_cast<float>(light + std::sqrt(noise.a * light + noise.b) * normal(random));
        }
      }
      const NoiseModel found = fit_noise(mosaic, 0.98f);
      for (const double signal : {0.05, 0.3, 0.7}) {
        const double expected = noise.a * signal + noise.b;
        EXPECT_NEAR((found.a * signal + found.b) / expected, 1.0, kFitError)
            << cfa.period << ": " << noise.a << ' ' << noise.b << " at " << signal;
      }
    }
  }
}

TEST(NoiseFit, LeavesNoiseAtBlack) {
  for (const bool has_black : {false, true}) {
    for (unsigned seed = 0; seed < 8; ++seed) {
      std::mt19937 random(seed);
      std::normal_distribution<double> normal;
      Mosaic mosaic{Image(192, 144, 1), bayer(0)};
      for (int y = 0; y < 144; ++y) {
        for (int x = 0; x < 192; ++x) {
          const double light = has_black && x < 48 && y < 48 ? 0.0 : 0.05 + 0.3 * x / 192.0;
          mosaic.samples.at(x, y, 0) =
              static_cast<float>(light + std::sqrt(4e-3 * light + 1e-6) * normal(random));
        }
      }
      const NoiseModel found = fit_noise(mosaic, 0.98f);
      EXPECT_GT(found.b, has_black ? 1e-7 : 0.1 * 4e-3 * 0.05) << seed;
      EXPECT_LT(found.b, 4e-3 * 0.05) << seed;
    }
  }
}

TEST(NoiseFit, ReadNoiseOfOtherIsosIsOfOneSensor) {
  const NoiseModel reference{.a = 2e-3, .b = 6e-5};
  EXPECT_EQ(with_least_read_noise({.a = 4e-3, .b = 0.0}, reference, 2.0).b, 6e-5);
  EXPECT_EQ(with_least_read_noise({.a = 1e-3, .b = 0.0}, reference, 0.5).b, 1.5e-5);
  EXPECT_EQ(with_least_read_noise({.a = 4e-3, .b = 1e-4}, reference, 2.0).b, 1e-4) << "more is kept";
}

TEST(NoiseFit, SaysNothingOfNothing) {
  const NoiseModel found = fit_noise({Image(48, 48, 1, 1.0f), bayer(0)}, 0.98f);
  EXPECT_EQ(found.a + found.b, 0.0) << "all saturated";
}

TEST(GlobalMotionTest, FindsATurnBesideAThingThatMoves) {
  constexpr int width = 120, height = 90;
  const auto truth = [](int x, int y) {
    const double u = x - 59.5, v = y - 44.5;
    return Vec2{1.3 + 0.004 * u - 0.01 * v, -0.7 + 0.01 * u + 0.004 * v};
  };
  const auto texture = [](double x, double y) {
    return 12.0 * (std::sin(0.55 * x + 0.2 * y) + std::sin(0.4 * y - 0.13 * x) +
                   std::sin(0.23 * x * std::cos(0.02 * y)));
  };
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Image target(width, height, 1), source(width, height, 1), offset(width, height, 2);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      source.at(x, y, 0) = static_cast<float>(texture(x, y) + normal(random));
      const Vec2 at = truth(x, y);
      const bool moves = x > 80 && y < 40;
      target.at(x, y, 0) = static_cast<float>(moves ? texture(x + 7, y) : texture(x + at.x, y + at.y)) +
                           static_cast<float>(normal(random));
      offset.at(x, y, 0) = static_cast<float>((moves ? 7.0 : at.x) + 0.4 * normal(random));
      offset.at(x, y, 1) = static_cast<float>((moves ? 0.0 : at.y) + 0.4 * normal(random));
    }
  }
  const GlobalMotion motion = fit_global_motion(target, source, offset);
  double largest = 0.0;
  for (int y = 0; y < height; y += 5) {
    for (int x = 0; x < width; x += 5) {
      const Imath::V2d found = motion.offset(x, y, width, height);
      largest = std::max(largest, std::hypot(found.x - truth(x, y).x, found.y - truth(x, y).y));
    }
  }
  EXPECT_LT(largest, 0.2);
  const GlobalMotion none = fit_global_motion(Image(30, 30, 1), Image(30, 30, 1), Image(30, 30, 2, 0.5f));
  EXPECT_EQ(none.offset(3, 4, 30, 30), Imath::V2d(0.0, 0.0)) << "without texture nothing moves";
}

double sharpness(const Mosaic& mosaic, const NoiseModel& noise) {
  return sharpness(contrast_of(mosaic), noise, 0.0);
}

TEST(Sharpness, FallsWithBlur) {
  const CfaPattern cfa = bayer(0);
  const Image sharp = photographed(cfa, 96, 96, {.shift = {}, .noise = 1.0, .seed = 1});
  Image blurred = sharp;
  for (int y = 0; y < 96; ++y) {
    for (int x = 6; x < 90; ++x) {
      const double mean = (scene(x - 6, y, cfa.color(x, y)) + scene(x, y, cfa.color(x, y)) +
                           scene(x + 6, y, cfa.color(x, y))) /
                          3.0;
      blurred.at(x, y, 0) = static_cast<float>(mean + sharp.at(x, y, 0) - scene(x, y, cfa.color(x, y)));
    }
  }
  EXPECT_GT(sharpness({sharp, cfa}, kNoise), 1.02 * sharpness({blurred, cfa}, kNoise));
}

TEST(Sharpness, OwesNothingToTheNoise) {
  for (const CfaPattern& cfa : {bayer(0), x_trans()}) {
    const auto of_noise = [&](double noise) {
      const Image picture = photographed(cfa, 192, 192, {.shift = {}, .noise = noise, .seed = 1});
      return sharpness({picture, cfa}, {.a = noise * noise * kNoise.a, .b = noise * noise * kNoise.b});
    };
    EXPECT_NEAR(of_noise(3.0) / of_noise(1.0), 1.0, 0.03) << cfa.period;
  }
}

/// A noisy picture of fine waves, blurred `blur` times.
Mosaic waves(int blur, double exposure, double a, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Image light(192, 144, 1);
  for (int y = 0; y < 144; ++y) {
    for (int x = 0; x < 192; ++x) {
      light.at(x, y, 0) =
          static_cast<float>(0.24 + 0.1 * std::sin(x / 4.1) * std::cos(y / 5.3) +
                             0.08 * std::sin((x + y) / 7.0) + 0.05 * std::cos(x / 2.3 - y / 3.1));
    }
  }
  for (; blur > 0; --blur) {
    const Image sharper = light;
    for (int y = 0; y < 144; ++y) {
      for (int x = 0; x < 192; ++x) {
        light.at(x, y, 0) = (sharper.at(x, y, 0) + sharper.at(std::max(x - 2, 0), y, 0) +
                             sharper.at(std::min(x + 2, 191), y, 0) + sharper.at(x, std::max(y - 1, 0), 0) +
                             sharper.at(x, std::min(y + 1, 143), 0)) /
                            5.0f;
      }
    }
  }
  Mosaic mosaic{Image(192, 144, 1), bayer(0)};
  for (std::size_t i = 0; i < light.pixel_count(); ++i) {
    const double value = exposure * light.data()[i];
    mosaic.samples.data()[i] = static_cast<float>(value + std::sqrt(a * value + 1e-6) * normal(random));
  }
  return mosaic;
}

struct Taken {
  int blur;
  double exposure = 1.0;
};

/// The sharpest of frames of one ISO whose noise is fitted.
std::size_t sharpest(const std::vector<Taken>& burst, double a, unsigned seed) {
  std::vector<NoiseBlock> blocks;
  std::vector<Contrast> contrasts;
  for (const Taken& taken : burst) {
    const auto number = static_cast<unsigned>(contrasts.size());
    const Mosaic mosaic = waves(taken.blur, taken.exposure, a, 10 * seed + number);
    contrasts.push_back(contrast_of(mosaic));
    std::ranges::move(noise_blocks(mosaic, 0.98f), std::back_inserter(blocks));
  }
  const NoiseModel noise = fit_noise(blocks);
  std::vector<double> sharp;
  for (std::size_t i = 0; i < burst.size(); ++i)
    sharp.push_back(sharpness(contrasts[i], noise, kFitError) / std::pow(burst[i].exposure, 2.0));
  return static_cast<std::size_t>(std::ranges::max_element(sharp) - sharp.begin());
}

TEST(Sharpness, RanksNoDarkFrameByItsNoise) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    EXPECT_NE(sharpest({{0}, {0}, {0}, {2, 0.25}}, 2e-3, seed), 3u) << seed;
    EXPECT_NE(sharpest({{0}, {0}, {0}, {0, 0.25}}, 2e-3, seed), 3u) << "equally sharp, but noisier: " << seed;
    EXPECT_EQ(sharpest({{2}, {2}, {2}, {0, 0.25}}, 2e-4, seed), 3u) << "alone sharp, and not noisy: " << seed;
  }
}

TEST(Sharpness, RanksEqualExposuresWhateverTheFitsErr) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    for (const double a : {2e-4, 2e-3, 8e-3}) {
      EXPECT_EQ(sharpest({{1}, {1}, {0}, {2}}, a, seed), 2u) << a << ' ' << seed;
    }
  }
}

}  // namespace
}  // namespace becalm::filter
