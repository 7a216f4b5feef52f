#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

/// What another library's reader finds in our files.
TEST(OtherReader, OpenImageIoReadsTheSame) {
  const TemporaryFolder folder;
  const std::string path = folder.path("image.exr");
  Frame frame(1, 20, 10);
  Image& beauty = frame.add(Aov::beauty);
  Image& motion = frame.add(Aov::motion);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      for (int c = 0; c < 4; ++c) beauty.at(x, y, c) = test_value(std::string(1, "RGBA"[c]), x, y);
      for (int c = 0; c < 2; ++c) motion.at(x, y, c) = -test_value(std::string(1, "XY"[c]), x, y);
    }
  }
  write_exr(path, frame, {{"becalm:preset", "final"}});

  const auto input = OIIO::ImageInput::open(path);
  ASSERT_TRUE(input) << OIIO::geterror();
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.width, 20);
  EXPECT_EQ(spec.height, 10);
  EXPECT_EQ(spec.channelnames, (std::vector<std::string>{"R", "G", "B", "A", "motion.X", "motion.Y"}));
  EXPECT_EQ(spec.get_string_attribute("becalm:preset"), "final");
  EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
  std::vector<float> pixels(20 * 10 * 6);
  ASSERT_TRUE(input->read_image(0, 0, 0, -1, OIIO::TypeFloat, pixels.data())) << input->geterror();
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      const float* pixel = &pixels[(y * 20 + x) * 6];
      for (int c = 0; c < 4; ++c) EXPECT_EQ(pixel[c], beauty.at(x, y, c));
      for (int c = 0; c < 2; ++c) EXPECT_EQ(pixel[4 + c], motion.at(x, y, c));
    }
  }
}

TEST(OtherReader, WeReadWhatOpenImageIoWrites) {
  const TemporaryFolder folder;
  const std::string path = folder.path("image.exr");
  OIIO::ImageSpec spec(9, 7, 4, OIIO::TypeDesc::HALF);
  spec.channelnames = {"R", "G", "B", "Z"};
  spec.channelformats = {OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF,
                         OIIO::TypeDesc::FLOAT};
  spec.x = -4;
  spec.y = 2;
  spec.attribute("compression", "piz");
  std::vector<float> pixels(9 * 7 * 4);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = 0.125f * static_cast<float>(i);
  const auto output = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(output && output->open(path, spec));
  ASSERT_TRUE(output->write_image(OIIO::TypeFloat, pixels.data()));
  ASSERT_TRUE(output->close());

  const LoadedFrame loaded = read_exr(path, 1, AovSet().set());
  ASSERT_TRUE(loaded.frame.has(Aov::depth));
  EXPECT_EQ(loaded.frame.image(Aov::beauty).at(8, 6, 2), 0.125f * (62 * 4 + 2));
  EXPECT_EQ(loaded.frame.image(Aov::depth).at(8, 6, 0), 0.125f * (62 * 4 + 3));
}

}  // namespace
}  // namespace becalm::io
