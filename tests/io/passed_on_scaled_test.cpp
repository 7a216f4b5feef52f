// What is written at another scale or for a checkerboard: attributes, and the samples of passed-on channels.

#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "frame/io/exr.h"
#include "frame/io/jitter_text.h"
#include "tests/io/exr_files.h"
#include "tests/io/passed_on_fixture.h"

namespace becalm::io {
namespace {

TEST_F(PassedOn, AScaledEyeHasItsFocalLengthInTheNewPixels) {
  Frame eye(1, 8, 6);
  eye.add(Aov::beauty, 0.5f);
  eye.set_stereo(StereoView{{.focal_px = 100.0, .separation = 0.2, .convergence = 4.0}, Eye::left});
  write_exr(source_, eye, {});
  const LoadedFrame loaded = read_exr(source_, 1, {});
  ASSERT_TRUE(loaded.frame.stereo());
  Frame scaled(1, 16, 12);
  scaled.add(Aov::beauty, 0.5f);
  write_denoised_exr(result_, scaled, {}, loaded, {}, {.scale = {2, 1}, .type = {}});
  const std::optional<StereoView> result = read_exr(result_, 1, {}).frame.stereo();
  ASSERT_TRUE(result);
  EXPECT_DOUBLE_EQ(result->camera.focal_px, 200.0);
  EXPECT_DOUBLE_EQ(result->camera.separation, 0.2);
}

TEST_F(PassedOn, MotionAloneIsScaledInBothDirections) {
  write_test_file(source_, {named_part("rgba", layer_channels("", {"R", "G", "B"})),
                            named_part("vector", layer_channels("", {"X", "Y", "Z", "W"})),
                            named_part("normal", layer_channels("", {"X", "Y", "Z"}))});
  const LoadedFrame loaded = read_exr(source_, 1, {});
  Frame scaled(1, 16, 12);
  scaled.add(Aov::beauty, 0.5f);
  write_denoised_exr(result_, scaled, {}, loaded, {}, {.scale = {2, 1}, .type = {}});
  for (const auto& [part, factor] : {std::pair{1, 2.0f}, {2, 1.0f}}) {
    for (const auto& [channel, bytes] : read_planes(result_, part)) {
      float value;
      std::memcpy(&value, bytes.data(), sizeof value);
      EXPECT_EQ(value, factor * test_value(channel, 0, 0)) << channel << " of part " << part;
    }
  }
}

TEST_F(PassedOn, PartsOfACheckerboardAreOfOneBoardWhereverTheyBegin) {
  Imf::Header beauty = scanline_part(window(0, 0, 8, 6), {{"R"}, {"G"}, {"B"}});
  beauty.insert(kCheckerboardAttribute, Imf::StringAttribute("even"));
  for (const Imath::Box2i& covered : {window(0, 0, 8, 6), window(1, 0, 6, 6), window(2, 3, 5, 3)}) {
    write_test_file(source_, {beauty, scanline_part(covered, {{"mask.Y", Imf::FLOAT}})});
    const LoadedFrame loaded = read_exr(source_, 1, {});
    ASSERT_TRUE(loaded.frame.checkerboard());
    write_denoised_exr(result_, loaded.frame, {}, loaded, {});
    const std::vector<char> before = read_planes(source_, 1).at("mask.Y");
    const std::vector<char> after = read_planes(result_, 1).at("mask.Y");
    ASSERT_EQ(before.size(), after.size());
    const int width = covered.max.x - covered.min.x + 1;
    for (int y = covered.min.y; y <= covered.max.y; ++y) {
      for (int x = covered.min.x; x <= covered.max.x; ++x) {
        const auto at =
            static_cast<std::ptrdiff_t>(sizeof(float)) * ((y - covered.min.y) * width + x - covered.min.x);
        const bool kept =
            std::equal(after.begin() + at, after.begin() + at + sizeof(float), before.begin() + at);
        EXPECT_EQ(kept, (x + y) % 2 == 0) << x << ',' << y << " of the part from " << covered.min.x;
      }
    }
  }
}

}  // namespace
}  // namespace becalm::io
