// The largest frames that antialiasing takes: what it tells is what its chain can be planned for.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "filter/antialias/antialias_chain.h"
#include "filter/antialias/antialias_filter.h"
#include "tests/filter/device_fixture.h"

namespace becalm::filter {
namespace {

class AntialiasSizesTest : public DeviceTest {
 protected:
  /// Whether a chain for results of this size, which are `scale` times as wide and high as the frames, can be
  /// planned; expects that the size is told to be taken if so.
  static bool is_taken(AntialiasSettings settings, gpu::Extent full, int scale) {
    settings.scale = {.numerator = scale};
    const AntialiasTask task{.settings = settings,
                             .full = full,
                             .sampled = {full.width / scale, full.height / scale},
                             .used = wanted_aovs(settings),
                             .diagnostics = {}};
    const std::string problem =
        size_problem(device(), settings, {{0, 0}, {task.sampled.width - 1, task.sampled.height - 1}});
    AntialiasChain passes(device(), task);
    try {
      passes.chain.plan();
    } catch (const gpu::DeviceLimitError& error) {
      EXPECT_NE(problem, "") << error.what();
      return false;
    }
    EXPECT_EQ(problem, "");
    return true;
  }
};

TEST_F(AntialiasSizesTest, AreThoseThatAreTold) {
  const gpu::DeviceInfo& info = device().info();
  if (!info.is_processor) GTEST_SKIP() << "other limits of " << info.name << " may come first";
  constexpr int width = 4096;
  const int most =
      static_cast<int>(std::min(info.max_storage_buffer_bytes / 8, info.max_texel_buffer_elements) / width);
  EXPECT_GE(most, 2160) << "DCI 4K";
  for (const std::string_view name : kAntialiasPresets) {
    for (const Directions directions : {Directions::forward, Directions::both}) {
      AntialiasSettings settings = antialias_preset(name);
      settings.directions = directions;
      for (const int scale : {1, 2}) {
        SCOPED_TRACE(std::string(name) + " " + to_string(settings) + " scale " + std::to_string(scale));
        EXPECT_TRUE(is_taken(settings, {width, most / scale * scale}, scale));
        EXPECT_FALSE(is_taken(settings, {width, (most / scale + 1) * scale}, scale));
      }
    }
  }
}

}  // namespace
}  // namespace becalm::filter
