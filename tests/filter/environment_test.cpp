// The environment where it is seen directly: what a renderer calls its albedo must not matter.
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "filter/order.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
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

Frame leaves_before_sky(int number, Sky convention) {
  std::mt19937 random(static_cast<unsigned>(number));
  std::normal_distribution<double> noise;
  Frame frame(number, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance);
  Image& albedo = frame.add(Aov::albedo);
  Image& normal = frame.add(Aov::normal);
  Image& depth = frame.add(Aov::depth);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool leaf = is_leaf(x, y, number);
      depth.at(x, y, 0) = leaf ? 4.0f : kInf;
      normal.at(x, y, 2) = leaf ? 1.0f : 0.0f;
      for (int c = 0; c < 3; ++c) {
        const double a = 0.1 + 0.2 * pattern(4 * (x - 3 * number), 4 * y, 50 + c);
        const double light = leaf ? a : sky(x, y, c);
        const double sigma = (leaf ? 0.3 : 0.005) * light;
        beauty.at(x, y, c) = static_cast<float>(light + sigma * noise(random));
        variance.at(x, y, c) = static_cast<float>(sigma * sigma);
        albedo.at(x, y, c) = static_cast<float>(leaf                      ? a
                                                : convention == Sky::one  ? 1
                                                : convention == Sky::zero ? 0
                                                                          : light);
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
        const double truth = leaf ? 0.1 + 0.2 * pattern(4 * (x - 3 * number), 4 * y, 50 + c) : sky(x, y, c);
        const double e = std::pow(frame.image(Aov::beauty).at(x, y, c) / truth - 1, 2);
        (leaf ? sum.leaf : sum.sky) += e;
        (leaf ? count.leaf : count.sky) += 1;
      }
    }
  }
  return {std::sqrt(sum.sky / count.sky), std::sqrt(sum.leaf / count.leaf)};
}

class EnvironmentTest : public DeviceTest {};

TEST_F(EnvironmentTest, KeepsItsDetailBehindMovingLeavesWhateverItsAlbedoIsCalled) {
  for (const auto& [convention, name] :
       {std::pair{Sky::one, "1"}, {Sky::zero, "0"}, {Sky::radiance, "its radiance"}}) {
    Settings settings = preset("balanced");
    settings.directions = Directions::forward;
    const Frame first = leaves_before_sky(1, convention);
    SequenceFilter filter(device(), settings, kWidth, kHeight, first.aovs(), {});
    for (int number = 1; number <= 4; ++number) {
      const Frame noisy = leaves_before_sky(number, convention);
      const Errors before = errors(noisy, number);
      const Errors after = errors(filter.denoise(noisy).frame, number);
      // The sky's own noise is half a percent; what leaves leave behind, a frame late, is 30 % and more.
      EXPECT_LT(after.sky, 0.015) << "albedo " << name << ", frame " << number;
      EXPECT_LT(after.leaf, 0.75 * before.leaf) << "albedo " << name << ", frame " << number;
    }
  }
}

}  // namespace
}  // namespace becalm::filter
