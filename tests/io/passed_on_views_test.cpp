// What is written for files of both eyes.

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <optional>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/passed_on_fixture.h"

namespace becalm::io {
namespace {

/// Doubles every beauty of the source, read in this window or its own, and writes them.
void denoise_views(const std::string& source, const std::string& result,
                   const std::optional<Imath::Box2i>& seen = std::nullopt,
                   const DenoisedFormat& format = {}) {
  LoadedFrame loaded = read_exr(source, 1, {}, {}, LightGroups::leave, seen);
  const auto denoise = [](Frame& frame) {
    for (float& value : frame.image(Aov::beauty).data()) value = 2.0f * value + 1.0f;
    frame.add(Aov::gain, 0.25f);
  };
  denoise(loaded.frame);
  std::vector<Frame> others;
  for (LoadedView& view : loaded.other_views) {
    denoise(view.frame);
    others.push_back(view.frame);
  }
  write_denoised_exr(result, loaded.frame, others, loaded, {{"becalm:preset", "final"}}, format);
}

TEST_F(PassedOn, BothEyesOfOnePart) {
  Imf::Header header =
      scanline_part(window(0, 0, 6, 4),
                    {{"R"}, {"G"}, {"B"}, {"right.R"}, {"right.G"}, {"right.B"}, {"raw.id", Imf::UINT}});
  Imf::addMultiView(header, {"left", "right"});
  write_test_file(source_, {header});
  denoise_views(source_, result_);
  expect_same_but_for({"R", "G", "B", "right.R", "right.G", "right.B"});
  expect_same_header();
  const LoadedFrame result = read_exr(result_, 1, AovSet().set());
  ASSERT_EQ(result.other_views.size(), 1u);
  const LoadedView& right = result.other_views[0];
  EXPECT_EQ(right.view, "right");
  EXPECT_EQ(right.frame.image(Aov::beauty).at(5, 3, 1),
            Imath::half(2.0f * test_value("right.G", 5, 3) + 1.0f));
  EXPECT_EQ(result.frame.image(Aov::beauty).at(5, 3, 1), Imath::half(2.0f * test_value("G", 5, 3) + 1.0f));
  EXPECT_EQ(right.layers[static_cast<std::size_t>(Aov::gain)]->channels[0], "gain.right.Y");
  EXPECT_EQ(right.frame.image(Aov::gain).at(5, 3, 0), 0.25f);
}

TEST_F(PassedOn, AnEyeAPart) {
  Imf::Header right = named_part("right", {{"R"}, {"G"}, {"B"}, {"raw.id", Imf::UINT}}, "right");
  right.dataWindow() = window(1, 1, 4, 3);
  write_test_file(source_, {named_part("left", {{"R"}, {"G"}, {"B"}}, "left"), right,
                            named_part("left.depth", {{"Z", Imf::FLOAT}}, "left")});
  denoise_views(source_, result_);
  expect_same_but_for(kBeauty, 0);
  expect_same_but_for(kBeauty, 1);
  expect_same_but_for({}, 2);
  for (int part = 0; part < 3; ++part) expect_same_header(part);
  const LoadedFrame result = read_exr(result_, 1, AovSet().set());
  ASSERT_EQ(result.other_views.size(), 1u);
  EXPECT_EQ(result.other_views[0].frame.width(), 4);
  EXPECT_EQ(result.other_views[0].frame.image(Aov::beauty).at(0, 0, 2),
            Imath::half(2.0f * test_value("B", 1, 1) + 1.0f));
  EXPECT_TRUE(result.frame.has(Aov::depth));
  EXPECT_FALSE(result.other_views[0].frame.has(Aov::depth));
}

TEST_F(PassedOn, EyesOfTwoWindowsSeenInALargerOne) {
  Imf::Header left = named_part("left", {{"R"}, {"G"}, {"B"}, {"raw.id", Imf::UINT}}, "left");
  left.dataWindow() = window(2, 0, 3, 4);
  Imf::Header right = named_part("right", {{"R"}, {"G"}, {"B"}}, "right");
  right.dataWindow() = window(1, 1, 4, 3);
  write_test_file(source_, {left, right});
  denoise_views(source_, result_, window(-1, -2, 8, 9), {.type = PixelType::float32, .compression = "zips"});
  expect_same_but_for(kBeauty, 0);
  expect_same_but_for(kBeauty, 1);
  const LoadedFrame result = read_exr(result_, 1, {});
  ASSERT_EQ(result.other_views.size(), 1u);
  EXPECT_EQ(result.window, left.dataWindow());
  EXPECT_EQ(result.other_views[0].window, right.dataWindow());
  EXPECT_EQ(result.frame.image(Aov::beauty).at(1, 2, 0), 2.0f * Imath::half(test_value("R", 3, 2)) + 1.0f);
  EXPECT_EQ(result.other_views[0].frame.image(Aov::beauty).at(2, 1, 2),
            2.0f * Imath::half(test_value("B", 3, 2)) + 1.0f);
  for (const int part : {0, 1}) {
    const Imf::Header after = read_header(result_, part);
    EXPECT_EQ(after.compression(), Imf::ZIPS_COMPRESSION);
    for (const char* name : {"R", "G", "B"}) EXPECT_EQ(after.channels()[name].type, Imf::FLOAT) << name;
  }
}

TEST_F(PassedOn, AFrameSmallerThanTheFilesWindowIsAnError) {
  write_test_file(source_, {scanline_part(window(0, 0, 6, 4), kMixed)});
  try {
    denoise_views(source_, result_, window(0, 1, 9, 9));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::bad_input);
    EXPECT_EQ(std::string(error.what()), source_ + ": its data window is not inside the denoised frame's");
  }
}

}  // namespace
}  // namespace becalm::io
