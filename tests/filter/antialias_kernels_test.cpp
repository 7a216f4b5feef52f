// Kernels of temporal antialiasing alone: sharpening, and the choice between two histories.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include "filter/antialias/sharpener.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/reference/grid.h"
#include "tests/filter/task.h"

namespace becalm::filter {
namespace {

class AntialiasKernelsTest : public DeviceTest {};

TEST_F(AntialiasKernelsTest, SharpeningIsThatOfTheReference) {
  constexpr int width = 23, height = 14;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  reference::Grid<std::array<float, 3>> color(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // From no contrast at the left to all of it.
      for (float& value : color.at(x, y)) value = 1.0f - unit(random) * static_cast<float>(x) / (width - 1);
    }
  }
  for (const float amount : {0.0f, 0.4f, 1.0f}) {
    SharpenPasses passes(device(), task_with_variance(preset("draft"), {width, height}), {width, height});
    passes.chain.build();
    passes.chain.upload<float>(passes.amount)[0] = amount;
    for (std::size_t i = 0; i < color.data.size(); ++i)
      std::ranges::copy(color.data[i], passes.chain.upload<float>(passes.color).begin() + 4 * i);
    passes.chain.run();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        std::array<double, 3> low, high, room;
        for (std::size_t c = 0; c < 3; ++c) {
          low[c] = high[c] = color.at(x, y)[c];
          for (int k = 0; k < 9; ++k) {
            low[c] = std::min<double>(low[c], color.clamped(x + k % 3 - 1, y + k / 3 - 1)[c]);
            high[c] = std::max<double>(high[c], color.clamped(x + k % 3 - 1, y + k / 3 - 1)[c]);
          }
          room[c] = std::sqrt(low[c] / high[c]);
        }
        const double weight = 0.8 * amount * *std::ranges::min_element(room);
        for (std::size_t c = 0; c < 3; ++c) {
          const double cross = 0.25 * (double{color.clamped(x - 1, y)[c]} + color.clamped(x + 1, y)[c] +
                                       color.clamped(x, y - 1)[c] + color.clamped(x, y + 1)[c]);
          const double sharp = (color.at(x, y)[c] - weight * cross) / (1.0 - weight);
          ASSERT_NEAR(passes.chain.download<float>(passes.sharpened)[4 * (y * width + x) + c],
                      std::clamp(sharp, low[c], high[c]), 1e-5)
              << x << ',' << y << " amount " << amount;
        }
      }
    }
  }
}

/// Even images: whether the search's history is taken in place of the vectors', where they differ from the
/// frame by so much and its variance is 1.
bool takes_the_search(gpu::Device& device, float vectors_error, float search_error) {
  constexpr gpu::Extent full{5, 4};
  gpu::Chain chain(device, "choice test");
  const auto input = [&](const std::string& name, gpu::Format format) {
    return chain.input(name, format, full);
  };
  const gpu::ImageId color = input("color", gpu::Format::f32x4);
  const gpu::ImageId vectors = input("vectors", gpu::Format::f32x4);
  const gpu::ImageId search = input("search", gpu::Format::f32x4);
  const gpu::ImageId stats = input("stats", gpu::Format::f32x2);
  const gpu::ImageId offset = input("offset", gpu::Format::f32x2);
  const gpu::ImageId chosen = chain.image("chosen", gpu::Format::f32x4, full);
  chain.pass("antialias/choose_history")
      .read("color", color, gpu::reach(1))
      .read("vectors_color", vectors, gpu::reach(1))
      .read("vectors_stats", stats, gpu::reach(1))
      .read("search_color", search, gpu::reach(1))
      .read("search_stats", stats, gpu::reach(1))
      .read("variance", stats, gpu::reach(1))
      .read("vectors_offset", offset)
      .read("search_offset", offset)
      .write("warped_color", chosen)
      .write("warped_stats", chain.image("chosen.stats", gpu::Format::f32x2, full))
      .write("offset", chain.image("chosen.offset", gpu::Format::f32x2, full))
      .dispatch(full);
  chain.output(chosen);
  chain.build();
  std::ranges::fill(chain.upload<float>(color), 10.0f);
  std::ranges::fill(chain.upload<float>(vectors), 10.0f + vectors_error);
  std::ranges::fill(chain.upload<float>(search), 10.0f - search_error);
  std::ranges::fill(chain.upload<float>(stats), 1.0f);
  std::ranges::fill(chain.upload<float>(offset), 0.0f);
  chain.run();
  const auto result = chain.download<float>(chosen);
  EXPECT_EQ(std::ranges::count(result, result[0]), static_cast<std::ptrdiff_t>(result.size()));
  return result[0] < 10.0f;
}

TEST_F(AntialiasKernelsTest, TheSearchMustBeClearlyBetterWhereVectorsFail) {
  // A squared error of three variances or less is noise; of a larger one a quarter may be left.
  EXPECT_FALSE(takes_the_search(device(), std::sqrt(2.9f), 0.1f));
  EXPECT_TRUE(takes_the_search(device(), std::sqrt(3.1f), 0.1f));
  EXPECT_TRUE(takes_the_search(device(), 4.0f, 1.95f));
  EXPECT_FALSE(takes_the_search(device(), 4.0f, 2.05f));
}

}  // namespace
}  // namespace becalm::filter
