#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

class ExrWrite : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  const std::string path_ = folder_.path("new/folder/image.exr");
};

Frame full_frame(int width, int height) {
  Frame frame(3, width, height);
  for (const AovInfo& entry : kAovTable) {
    Image& image = frame.add(entry.aov);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < image.channels(); ++c) {
          image.at(x, y, c) = test_value(std::string(entry.name) + entry.channels[c], x, y) - 0.25f;
        }
      }
    }
  }
  return frame;
}

bool same_values(const Image& a, const Image& b) {
  return a.same_shape(b) && std::equal(a.data().begin(), a.data().end(), b.data().begin());
}

TEST_F(ExrWrite, EveryAovComesBack) {
  // Multiples of 1/1024 below 2 are exact in half.
  for (const auto& [width, height] :
       {std::pair{1, 1}, std::pair{37, 19}, std::pair{5, 600}, std::pair{16384, 1}}) {
    const Frame frame = full_frame(width, height);
    for (const PixelType type : {PixelType::half, PixelType::float32}) {
      EXPECT_EQ(write_exr(path_, frame, {}, type).half_overflows, 0u);
      const LoadedFrame loaded = read_exr(path_, 3, AovSet().set());
      for (const AovInfo& entry : kAovTable) {
        EXPECT_TRUE(same_values(loaded.frame.image(entry.aov), frame.image(entry.aov))) << entry.name;
      }
    }
  }
  EXPECT_EQ(folder_.file_count(), 1u) << "no partial file stays";
}

TEST_F(ExrWrite, OnlyTheFramesAovsAreWritten) {
  Frame frame(1, 4, 4);
  frame.add(Aov::beauty);
  frame.add(Aov::normal);
  write_exr(path_, frame, {});
  const Planes planes = read_planes(path_);
  EXPECT_EQ(planes.size(), 7u);
  EXPECT_TRUE(planes.contains("R"));
  EXPECT_TRUE(planes.contains("normal.Z"));
}

TEST_F(ExrWrite, PixelTypesAndHeader) {
  write_exr(path_, full_frame(8, 4), {{"becalm:preset", "final"}, {"becalm:seed", "7"}});
  const Imf::Header header = read_header(path_);
  EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
  EXPECT_EQ(header.dataWindow(), window(0, 0, 8, 4));
  EXPECT_EQ(header.displayWindow(), window(0, 0, 8, 4));
  for (const char* name : {"R", "A", "albedo.G", "normal.X", "half_a.B", "half_b.R"}) {
    EXPECT_EQ(header.channels()[name].type, Imf::HALF) << name;
  }
  for (const char* name : {"variance.R", "depth.Z", "motion.X", "flow.Y", "error_mask.Y", "sample_count.Y"}) {
    EXPECT_EQ(header.channels()[name].type, Imf::FLOAT) << name;
  }
  EXPECT_EQ(read_attribute(path_, "becalm:preset"), "final");
  EXPECT_EQ(read_attribute(path_, "becalm:seed"), "7");
}

TEST_F(ExrWrite, HalfOverflowIsClampedAndCounted) {
  Frame frame(1, 4, 2);
  Image& beauty = frame.add(Aov::beauty);
  const float values[] = {65504.0f, 65505.0f, -1e30f, kInf, -kInf, kNan, 1e-30f, -65504.0f};
  std::copy(std::begin(values), std::end(values), beauty.data().begin());
  EXPECT_EQ(write_exr(path_, frame, {}).half_overflows, 2u);
  const Image read = read_exr(path_, 1, {}).frame.image(Aov::beauty);
  EXPECT_EQ(read.data()[0], 65504.0f);
  EXPECT_EQ(read.data()[1], 65504.0f);
  EXPECT_EQ(read.data()[2], -65504.0f);
  EXPECT_EQ(read.data()[3], kInf);
  EXPECT_EQ(read.data()[4], -kInf);
  EXPECT_TRUE(std::isnan(read.data()[5]));
  EXPECT_EQ(read.data()[6], 0.0f);
  EXPECT_EQ(read.data()[7], -65504.0f);

  EXPECT_EQ(write_exr(path_, frame, {}, PixelType::float32).half_overflows, 0u);
  EXPECT_EQ(read_exr(path_, 1, {}).frame.image(Aov::beauty).data()[2], -1e30f);
}

TEST_F(ExrWrite, FloatLayersKeepInfinityAndExtremes) {
  Frame frame(1, 2, 1);
  frame.add(Aov::beauty);
  frame.add(Aov::depth, kInf);
  frame.add(Aov::variance, 1e-30f);
  EXPECT_EQ(write_exr(path_, frame, {}).half_overflows, 0u);
  const Frame read = read_exr(path_, 1, AovSet().set()).frame;
  EXPECT_EQ(read.image(Aov::depth).data()[1], kInf);
  EXPECT_EQ(read.image(Aov::variance).data()[0], 1e-30f);
}

TEST_F(ExrWrite, TheSameFrameGivesTheSameBytes) {
  const Frame frame = full_frame(70, 300);
  write_exr(path_, frame, {{"becalm:preset", "final"}});
  const std::string first = read_bytes(path_);
  set_exr_threads(3);
  write_exr(path_, frame, {{"becalm:preset", "final"}});
  set_exr_threads(0);
  EXPECT_EQ(read_bytes(path_), first);
}

}  // namespace
}  // namespace becalm::io
