// A kernel of temporal antialiasing alone: the choice between two histories.
#include <algorithm>
#include <cmath>
#include <string>

#include "filter/gpu/chain.h"
#include "tests/filter/device_fixture.h"

namespace becalm::filter {
namespace {

class AntialiasKernelsTest : public DeviceTest {};

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
