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

struct Samples {
  int of_pixel = 2;
  float rare = 0.04f;  ///< the part of them that meets the light
  float radiance = 1.0f;
};

/// An even radiance. A pixel of which no sample meets the light seems to be dark and without noise.
Frame sparsely_lit(int number, const SurfacePixel& surface, const Samples& samples = {}) {
  std::mt19937 random(static_cast<unsigned>(number));
  std::bernoulli_distribution hit(samples.rare);
  Frame frame = guided_frame(number, kWidth, kHeight, [&](int, int) { return surface; });
  const auto n = static_cast<float>(samples.of_pixel);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      float sum = 0.0f, squares = 0.0f;
      for (int i = 0; i < samples.of_pixel; ++i) {
        const float sample = samples.radiance * (hit(random) ? 1 / samples.rare : 0.02f);
        sum += sample;
        squares += sample * sample;
      }
      for (int c = 0; c < 3; ++c) {
        frame.image(Aov::beauty).at(x, y, c) = sum / n;
        frame.image(Aov::variance).at(x, y, c) = std::max(squares - sum * sum / n, 0.0f) / (n * (n - 1.0f));
      }
    }
  }
  return frame;
}

class SparseLightTest : public DeviceTest {};

/// Pixels that `stands_out(pixel, median of the 3x3 around it)`.
template <class StandsOut>
int count_pixels(const Image& beauty, const StandsOut& stands_out) {
  int count = 0;
  for (int y = 1; y < kHeight - 1; ++y) {
    for (int x = 1; x < kWidth - 1; ++x) {
      std::vector<float> around;
      for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) around.push_back(beauty.at(u, v, 1));
      }
      std::ranges::nth_element(around, around.begin() + 4);
      count += stands_out(beauty.at(x, y, 1), around[4]);
    }
  }
  return count;
}

int count_dark(const Image& beauty) {
  return count_pixels(beauty, [](float pixel, float median) { return pixel < 0.5f * median; });
}

int count_bright(const Image& beauty) {
  return count_pixels(beauty, [](float pixel, float median) { return pixel > 1.06f * median; });
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

TEST_F(SparseLightTest, LeavesNoSpecksWhereItFades) {
  // Histories are rejected here and there; what was merged is noisier there than around, which is no detail.
  SequenceFilter filter(device(), preset("balanced"), kWidth, kHeight, sparsely_lit(1, kWall).aovs());
  float radiance = 1.0f;
  for (int number = 1; number <= 6; ++number, radiance *= 0.83f) {
    const Frame noisy = sparsely_lit(number, kWall, {.of_pixel = 4, .rare = 0.25f, .radiance = radiance});
    EXPECT_LT(count_bright(denoise_frame(filter, noisy).frame.image(Aov::beauty)), 4) << "frame " << number;
  }
}

}  // namespace
}  // namespace becalm::filter::sparse_light_test
