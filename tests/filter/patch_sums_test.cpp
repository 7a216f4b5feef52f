// The patch sums of shaders/merge/box against plain loops, on sizes that are no multiple of a strip or
// workgroup.
#include "filter/merge/patch_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/filter/device_fixture.h"

namespace becalm {
namespace {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

class PatchSumsTest : public DeviceTest {
 protected:
  /// Whole numbers, whose sums are exact in any order.
  static std::vector<float> whole_numbers(std::size_t count) {
    std::mt19937 random(1);
    std::uniform_int_distribution<int> uniform(-1000, 1000);
    std::vector<float> values(count);
    std::ranges::generate(values, [&] { return static_cast<float>(uniform(random)); });
    return values;
  }

  static void expect_sums(Extent size, int radius) {
    SCOPED_TRACE(std::to_string(size.width) + "x" + std::to_string(size.height) + ", radius " +
                 std::to_string(radius));
    gpu::Chain chain(device(), "sums");
    const ImageId statistics = chain.input("statistics", Format::f32x4, size);
    const ImageId sums = filter::add_box_sums(chain, radius, size, statistics, "patch");
    chain.output(sums);
    chain.build();
    const std::vector<float> values = whole_numbers(4 * size.elements());
    std::ranges::copy(values, chain.upload<float>(statistics).begin());
    chain.run();
    const std::span<const float> result = chain.download<float>(sums);
    const auto index = [&](int x, int y, int c) {
      return 4 * (static_cast<std::size_t>(y) * size.width + x) + c;
    };
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        for (int c = 0; c < 4; ++c) {
          float expected = 0.0f;
          for (int v = std::max(y - radius, 0); v <= std::min(y + radius, size.height - 1); ++v) {
            for (int u = std::max(x - radius, 0); u <= std::min(x + radius, size.width - 1); ++u) {
              if (u == x && v == y) continue;
              expected += values[index(u, v, c)];
            }
          }
          ASSERT_EQ(result[index(x, y, c)], expected) << x << ", " << y << ", channel " << c;
        }
      }
    }
  }
};

TEST_F(PatchSumsTest, AreThoseOfPlainLoops) {
  for (const Extent size : {Extent{64, 64}, {1, 1}, {1, 70}, {70, 1}, {7, 5}, {67, 13}, {130, 9}}) {
    for (const int radius : {2, 3, 8}) expect_sums(size, radius);
  }
}

}  // namespace
}  // namespace becalm
