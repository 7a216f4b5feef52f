// The directly visible environment: the result must not depend on the albedo that a renderer writes for it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "filter/sequence/sequence_filter.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/guided_frame.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::environment_test {
namespace {

constexpr int kWidth = 72;
constexpr int kHeight = 48;
constexpr float kInf = std::numeric_limits<float>::infinity();

/// What renderers write as the albedo of pixels that show the environment.
enum class Sky { one, zero, radiance };

/// Radiance of the sky: faint clouds, and detail brighter than white.
double sky(int x, int y, int c) {
  const double clouds = 0.6 + 0.04 * pattern(3 * x, 3 * y, 20 + c);
  return pattern(x, y, 7) > 0.62 ? 12 * clouds : clouds;
}

bool is_leaf(int x, int y, int number) {
  return pattern(2 * (x - 3 * number), 2 * y, 40) > 0.55;
}

double leaf_albedo(int x, int y, int number, int c) {
  return 0.1 + 0.2 * pattern(4 * (x - 3 * number), 4 * y, 50 + c);
}

/// The radiance without noise.
double radiance(int x, int y, int number, int c) {
  return is_leaf(x, y, number) ? leaf_albedo(x, y, number, c) : sky(x, y, c);
}

Frame leaves_before_sky(int number, Sky convention) {
  std::mt19937 random(static_cast<unsigned>(number));
  std::normal_distribution<double> noise;
  Frame frame = guided_frame(number, kWidth, kHeight, [&](int x, int y) {
    const bool leaf = is_leaf(x, y, number);
    SurfacePixel surface{.albedo = {}, .normal_z = leaf ? 1.0f : 0.0f, .depth = leaf ? 4.0f : kInf};
    for (int c = 0; c < 3; ++c) {
      surface.albedo[c] = leaf || convention == Sky::radiance ? static_cast<float>(radiance(x, y, number, c))
                          : convention == Sky::one            ? 1.0f
                                                              : 0.0f;
    }
    return surface;
  });
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double light = radiance(x, y, number, c);
        const double sigma = (is_leaf(x, y, number) ? 0.3 : 0.005) * light;
        frame.image(Aov::beauty).at(x, y, c) = static_cast<float>(light + sigma * noise(random));
        frame.image(Aov::variance).at(x, y, c) = static_cast<float>(sigma * sigma);
      }
    }
  }
  return frame;
}

struct Errors {
  double sky = 0;
  double leaf = 0;
};

/// Root mean square of the relative errors.
Errors errors(const Frame& frame, int number) {
  Errors sum;
  Errors count;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool leaf = is_leaf(x, y, number);
      for (int c = 0; c < 3; ++c) {
        const double e = std::pow(frame.image(Aov::beauty).at(x, y, c) / radiance(x, y, number, c) - 1, 2);
        (leaf ? sum.leaf : sum.sky) += e;
        (leaf ? count.leaf : count.sky) += 1;
      }
    }
  }
  return {std::sqrt(sum.sky / count.sky), std::sqrt(sum.leaf / count.leaf)};
}

class EnvironmentTest : public DeviceTest {};

TEST_F(EnvironmentTest, LeavesBeforeItLeaveNothingBehindWhateverItsAlbedoIsCalled) {
  for (const auto& [convention, name] :
       {std::pair{Sky::one, "1"}, {Sky::zero, "0"}, {Sky::radiance, "its radiance"}}) {
    Settings settings = preset("balanced");
    settings.directions = Directions::forward;
    const Frame first = leaves_before_sky(1, convention);
    SequenceFilter filter(device(), settings, kWidth, kHeight, first.aovs());
    double least = 1e9;
    for (int number = 1; number <= 4; ++number) {
      const Frame noisy = leaves_before_sky(number, convention);
      const Errors after = errors(denoise_frame(filter, noisy).frame, number);
      // A trail that leaves leave in the next frame has an error of 30 % and more.
      EXPECT_LT(after.sky, 0.08) << "albedo " << name << ", frame " << number;
      least = std::min(least, after.leaf);
      EXPECT_LT(after.leaf, 3 * least) << "albedo " << name << ", frame " << number;
    }
  }
}

TEST_F(EnvironmentTest, StaysCleanBetweenLeavesWhetherDepthOrNormalTellsIt) {
  for (const Aov missing : {Aov::depth, Aov::normal}) {
    Frame noisy = leaves_before_sky(1, Sky::one);
    noisy.remove(missing);
    SequenceFilter filter(device(), preset("draft"), kWidth, kHeight, noisy.aovs());
    EXPECT_LT(errors(denoise_frame(filter, noisy).frame, 1).sky, 0.08)
        << "missing AOV " << static_cast<int>(missing);
  }
}

constexpr float kSunlessSky = 1.5f;

double from_sun(int x, int y, int number) {
  return std::hypot(x - 30 - 0.3 * number, y - 20);
}

/// The rising sun's disc at 4 samples per pixel: noisy at its edge, beside a clean sky.
Frame rising_sun(int number) {
  constexpr double radius = 3;
  constexpr float sun = 50000;
  std::mt19937 random(static_cast<unsigned>(number));
  Frame frame(number, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double covered = std::clamp(radius + 0.5 - from_sun(x, y, number), 0.0, 1.0);
      std::binomial_distribution<int> hits(4, covered);
      const float share = static_cast<float>(hits(random)) / 4;
      for (int c = 0; c < 3; ++c) {
        beauty.at(x, y, c) = kSunlessSky + sun * share;
        variance.at(x, y, c) = 1e-5f + sun * sun * share * (1 - share) / 3;
      }
    }
  }
  return frame;
}

TEST_F(EnvironmentTest, TheSunLeavesNothingOfItBesideIt) {
  Settings settings = preset("draft");
  settings.smooth = Smooth::none;
  settings.patch_radius = 3;
  SequenceFilter filter(device(), settings, kWidth, kHeight, rising_sun(1).aovs());
  for (int number = 1; number <= 6; ++number) {
    const Frame denoised = denoise_frame(filter, rising_sun(number)).frame;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (from_sun(x, y, number) < 3.5) continue;
        ASSERT_LT(denoised.image(Aov::beauty).at(x, y, 0), 10 * kSunlessSky)
            << x << ',' << y << " of frame " << number;
      }
    }
  }
}

}  // namespace
}  // namespace becalm::filter::environment_test
