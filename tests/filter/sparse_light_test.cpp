// Light all in rare samples: most pixels are black and seem to have no noise.
#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "filter/sequence/sequence_filter.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/guided_frame.h"

namespace becalm::filter::sparse_light_test {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

constexpr SurfacePixel kWall{.albedo = {0.6f, 0.6f, 0.6f}, .normal_z = 1.0f, .depth = 4.0f};
constexpr SurfacePixel kFog{
    .albedo = {1.0f, 1.0f, 1.0f}, .normal_z = 0.0f, .depth = std::numeric_limits<float>::infinity()};

/// An even radiance of 1. Few of its samples, two a pixel, meet the light; a pixel of which none does seems
/// to be dark and without noise.
Frame sparsely_lit(int number, const SurfacePixel& surface) {
  constexpr float rare = 0.04f;
  std::mt19937 random(static_cast<unsigned>(number));
  std::bernoulli_distribution hit(rare);
  Frame frame = guided_frame(number, kWidth, kHeight, [&](int, int) { return surface; });
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float a = hit(random) ? 1 / rare : 0.02f;
      const float b = hit(random) ? 1 / rare : 0.02f;
      for (int c = 0; c < 3; ++c) {
        frame.image(Aov::beauty).at(x, y, c) = 0.5f * (a + b);
        frame.image(Aov::variance).at(x, y, c) = 0.25f * (a - b) * (a - b);
      }
    }
  }
  return frame;
}

class SparseLightTest : public DeviceTest {};

/// Pixels of less than half the median around them.
int count_dark(const Image& beauty) {
  int dark = 0;
  for (int y = 1; y < kHeight - 1; ++y) {
    for (int x = 1; x < kWidth - 1; ++x) {
      std::vector<float> around;
      for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) around.push_back(beauty.at(u, v, 1));
      }
      std::ranges::nth_element(around, around.begin() + 4);
      dark += beauty.at(x, y, 1) < 0.5f * around[4];
    }
  }
  return dark;
}

void expect_no_holes(gpu::Device& device, const SurfacePixel& surface) {
  for (const std::string name : {"draft", "balanced", "final"}) {
    Settings settings = preset(name);
    settings.directions = Directions::forward;
    SequenceFilter filter(device, settings, kWidth, kHeight, sparsely_lit(1, surface).aovs());
    for (int number = 1; number <= 4; ++number) {
      const Frame denoised = denoise_frame(filter, sparsely_lit(number, surface)).frame;
      EXPECT_LT(count_dark(denoised.image(Aov::beauty)), 10) << name << ", frame " << number;
    }
  }
}

TEST_F(SparseLightTest, LeavesNoHolesInSurfaces) {
  expect_no_holes(device(), kWall);
}

TEST_F(SparseLightTest, LeavesNoHolesWhereThereIsNoSurface) {
  expect_no_holes(device(), kFog);
}

}  // namespace
}  // namespace becalm::filter::sparse_light_test
