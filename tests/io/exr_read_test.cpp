#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "frame/io/exr_channels.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

AovSet all_aovs() {
  return AovSet().set();
}

class ExrRead : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  const std::string path_ = folder_.path("image.exr");
};

const std::vector<TestChannel> kColour = {{"R"}, {"G"}, {"B"}, {"A"}};

void expect_colour(const Frame& frame, int min_x, int min_y) {
  const Image& beauty = frame.image(Aov::beauty);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      for (int c = 0; c < 4; ++c) {
        ASSERT_EQ(beauty.at(x, y, c), test_value(std::string(1, "RGBA"[c]), min_x + x, min_y + y))
            << x << ' ' << y << ' ' << c;
      }
    }
  }
}

TEST_F(ExrRead, FrameCoversTheDataWindow) {
  Imf::Header header = scanline_part(window(-3, 5, 17, 9), kColour);
  header.displayWindow() = window(0, 0, 100, 50);
  write_test_file(path_, {header});
  const LoadedFrame loaded = read_exr(path_, 42, {});
  EXPECT_EQ(loaded.frame.number(), 42);
  EXPECT_EQ(loaded.frame.width(), 17);
  EXPECT_EQ(loaded.frame.height(), 9);
  expect_colour(loaded.frame, -3, 5);
}

TEST_F(ExrRead, RefusesADataWindowBesideTheSequences) {
  write_test_file(path_, {scanline_part(window(0, 0, 8, 4), kColour)});
  EXPECT_EQ(read_exr(path_, 1, {}, {}, LightGroups::leave, window(7, 3, 8, 4)).frame.width(), 8);
  try {
    read_exr(path_, 1, {}, {}, LightGroups::leave, window(20, 0, 8, 4));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::bad_input);
    EXPECT_NE(std::string(error.what()).find("(0, 0) to (7, 3)"), std::string::npos) << error.what();
  }
}

// Of a large image, which takes the memory of the one before it.
TEST_F(ExrRead, BeyondTheWindowOfAPartIsWhatIsWhereNothingIsHit) {
  const Imath::Box2i all = window(0, 0, 300, 300);
  for (const Imath::Box2i& covered : {window(0, 0, 200, 250), window(100, 50, 200, 250)}) {
    write_test_file(path_,
                    {scanline_part(covered, joined({kColour, layer_channels("albedo", {"R", "G", "B"})}))});
    { const Image gone(300, 300, 3, 7.0f); }
    const Frame frame = read_exr(path_, 1, all_aovs(), {}, LightGroups::leave, all).frame;
    for (const Imath::V2i& at : {all.min, covered.min, covered.max, all.max}) {
      const float expected = covered.intersects(at) ? test_value("albedo.G", at.x, at.y) : 1.0f;
      EXPECT_EQ(frame.image(Aov::albedo).at(at.x, at.y, 1), expected) << at;
    }
  }
}

TEST_F(ExrRead, TiledMippedAndDecreasingLines) {
  write_test_file(path_, {tiled_part(window(-7, -9, 45, 300), kColour, 16, 24)});
  expect_colour(read_exr(path_, 1, {}).frame, -7, -9);
  write_test_file(path_, {tiled_part(window(3, 2, 33, 20), kColour, 8, 8, Imf::MIPMAP_LEVELS)});
  expect_colour(read_exr(path_, 1, {}).frame, 3, 2);
  Imf::Header decreasing = scanline_part(window(0, -300, 5, 700), kColour);
  decreasing.lineOrder() = Imf::DECREASING_Y;
  write_test_file(path_, {decreasing});
  expect_colour(read_exr(path_, 1, {}).frame, 0, -300);
}

TEST_F(ExrRead, OnePixel) {
  write_test_file(path_, {scanline_part(window(0, 0, 1, 1), kColour)});
  expect_colour(read_exr(path_, 1, {}).frame, 0, 0);
}

TEST_F(ExrRead, EveryPixelTypeAndEveryLosslessCompression) {
  for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                             Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    write_test_file(path_, {scanline_part(window(0, 0, 21, 40), {{"R"}, {"G", Imf::FLOAT}, {"B", Imf::UINT}},
                                          compression)});
    const Image beauty = read_exr(path_, 1, {}).frame.image(Aov::beauty);
    EXPECT_EQ(beauty.at(20, 39, 0), test_value("R", 20, 39));
    EXPECT_EQ(beauty.at(20, 39, 1), test_value("G", 20, 39));
    EXPECT_EQ(beauty.at(20, 39, 2), std::floor(test_value("B", 20, 39) * 1000.0f));
    EXPECT_EQ(beauty.at(20, 39, 3), 1.0f) << "a beauty without alpha is opaque";
  }
}

TEST_F(ExrRead, OnlyWantedAovsAreRead) {
  std::vector<TestChannel> channels = kColour;
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B", "Z"}) channels.push_back({name, Imf::FLOAT});
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), channels)});
  AovSet wanted;
  wanted.set(static_cast<std::size_t>(Aov::depth));
  wanted.set(static_cast<std::size_t>(Aov::motion));
  const LoadedFrame loaded = read_exr(path_, 1, wanted);
  EXPECT_TRUE(loaded.frame.has(Aov::beauty));
  EXPECT_TRUE(loaded.frame.has(Aov::depth));
  EXPECT_FALSE(loaded.frame.has(Aov::albedo));
  EXPECT_FALSE(loaded.frame.has(Aov::motion));
  EXPECT_TRUE(loaded.layers[static_cast<std::size_t>(Aov::albedo)]) << "found, though not wanted";
  EXPECT_EQ(loaded.frame.image(Aov::depth).at(3, 2, 0), test_value("Z", 3, 2));
}

TEST_F(ExrRead, BlenderMultilayer) {
  write_test_file(path_, {scanline_part(window(0, 0, 30, 20), blender_channels("View Layer.001"))});
  const LoadedFrame loaded = read_exr(path_, 1, all_aovs());
  const Frame& frame = loaded.frame;
  const std::string prefix = "View Layer.001.";
  EXPECT_EQ(frame.image(Aov::beauty).at(7, 3, 1), test_value(prefix + "Combined.G", 7, 3));
  EXPECT_EQ(frame.image(Aov::albedo).at(7, 3, 2), test_value(prefix + "Denoising Albedo.B", 7, 3));
  EXPECT_EQ(frame.image(Aov::normal).at(7, 3, 0), test_value(prefix + "Denoising Normal.X", 7, 3));
  EXPECT_EQ(frame.image(Aov::depth).at(7, 3, 0), test_value(prefix + "Depth.Z", 7, 3));
  // Cycles' vectors count y upwards, becalm's downwards.
  EXPECT_EQ(frame.image(Aov::motion).at(7, 3, 0), test_value(prefix + "Vector.X", 7, 3));
  EXPECT_EQ(frame.image(Aov::motion).at(7, 3, 1), -test_value(prefix + "Vector.Y", 7, 3));
}

TEST_F(ExrRead, OneLayerMayServeTwoAovs) {
  std::vector<TestChannel> channels = kColour;
  for (const char* name : {"x.R", "x.G", "x.B"}) channels.push_back({name, Imf::FLOAT});
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), channels)});
  const LoadedFrame loaded =
      read_exr(path_, 1, all_aovs(), {.layers = {{Aov::half_a, "x"}, {Aov::half_b, "x"}}});
  EXPECT_EQ(loaded.frame.image(Aov::half_a).at(1, 2, 1), test_value("x.G", 1, 2));
  EXPECT_EQ(loaded.frame.image(Aov::half_b).at(1, 2, 1), test_value("x.G", 1, 2));
}

TEST_F(ExrRead, PartsWithWindowsOfTheirOwn) {
  write_test_file(path_, {scanline_part(window(0, 0, 10, 10), kColour),
                          scanline_part(window(2, -4, 30, 9), {{"albedo.R"}, {"albedo.G"}, {"albedo.B"}}),
                          tiled_part(window(5, 5, 2, 2), {{"depth.Z", Imf::FLOAT}}, 16, 16)});
  const Frame frame = read_exr(path_, 1, all_aovs()).frame;
  expect_colour(frame, 0, 0);
  const Image& albedo = frame.image(Aov::albedo);
  EXPECT_EQ(albedo.at(2, 4, 0), test_value("albedo.R", 2, 4));
  EXPECT_EQ(albedo.at(9, 0, 2), test_value("albedo.B", 9, 0));
  EXPECT_EQ(albedo.at(1, 4, 0), 1.0f);
  EXPECT_EQ(albedo.at(2, 5, 0), 1.0f);
  EXPECT_EQ(frame.image(Aov::depth).at(6, 5, 0), test_value("depth.Z", 6, 5));
  EXPECT_TRUE(std::isinf(frame.image(Aov::depth).at(7, 5, 0)));
}

TEST_F(ExrRead, RadianceBeyondOpaqueEdgesIsUnknown) {
  const Imath::Box2i larger = window(0, 0, 6, 5);
  const auto value = [&](const Frame& frame, int x, int y) { return frame.image(Aov::beauty).at(x, y, 1); };
  write_test_file(path_, {scanline_part(window(1, 1, 3, 2), {{"R"}, {"G"}, {"B"}})});
  const Frame opaque = read_exr(path_, 1, all_aovs(), {}, LightGroups::leave, larger).frame;
  ASSERT_TRUE(opaque.cut());
  EXPECT_EQ(opaque.cut()->unknown_pixels, 6u * 5u - 3u * 2u);
  EXPECT_EQ(opaque.cut()->window, window(1, 1, 3, 2));
  EXPECT_TRUE(std::isnan(value(opaque, 0, 0)));
  EXPECT_TRUE(std::isnan(value(opaque, 5, 2)));
  EXPECT_EQ(value(opaque, 3, 2), test_value("G", 3, 2));
  write_test_file(path_, {scanline_part(window(1, 1, 3, 2), kColour)});
  const Frame cropped = read_exr(path_, 1, all_aovs(), {}, LightGroups::leave, larger).frame;
  int seen[2] = {};
  for (int x = 1; x < 4; ++x) {
    const bool is_opaque = cropped.image(Aov::beauty).at(x, 1, 3) >= 1.0f;
    ++seen[is_opaque ? 1 : 0];
    EXPECT_EQ(std::isnan(value(cropped, x, 0)), is_opaque) << "renderers crop what is empty";
  }
  EXPECT_GT(seen[0], 0);
  EXPECT_GT(seen[1], 0);
}

TEST_F(ExrRead, ChannelsOfWindowsThatBeginAnywhere) {
  for (const Imath::Box2i& covered : {window(5, 7, 16, 9), window(-5, -7, 16, 9), window(6, -4, 16, 10)}) {
    for (const int sampling : {1, 2}) {
      if (sampling == 2 && covered.min.x % 2 != 0) continue;  // OpenEXR refuses such files
      SCOPED_TRACE(std::to_string(covered.min.x) + " sampled every " + std::to_string(sampling));
      write_test_file(path_,
                      {scanline_part(covered, {{"R"}, {"x.U", Imf::UINT}, {"x.V", Imf::FLOAT, sampling}})});
      const ExrChannels file(path_);
      const Image sampled = file.read(0, "x.V");
      ASSERT_EQ(sampled.width(), 16 / sampling);
      for (int y = 0; y < sampled.height(); ++y) {
        for (int x = 0; x < sampled.width(); ++x) {
          ASSERT_EQ(sampled.at(x, y, 0),
                    test_value("x.V", covered.min.x + x * sampling, covered.min.y + y * sampling));
        }
      }
      const Image integers = file.read(0, "x.U");
      EXPECT_EQ(integers.at(15, 8, 1),
                std::floor(test_value("x.U", covered.min.x + 15, covered.min.y + 8) * 1000.0f));
      require_whole_exr(path_);
    }
  }
}

TEST_F(ExrRead, Attributes) {
  Imf::Header header = scanline_part(window(0, 0, 4, 4), kColour);
  header.insert("becalm:preset", Imf::StringAttribute("final"));
  write_test_file(path_, {header});
  EXPECT_EQ(read_attribute(path_, "becalm:preset"), "final");
  EXPECT_EQ(read_attribute(path_, "becalm:none"), "");
  EXPECT_EQ(read_attribute(path_, "compression"), "") << "not a text";
}

TEST_F(ExrRead, Description) {
  Imf::Header beauty =
      tiled_part(window(-2, 3, 20, 10),
                 {{"R"}, {"G"}, {"B"}, {"V.Vector.X"}, {"V.Vector.Y"}, {"raw.U", Imf::UINT}}, 16, 8);
  beauty.displayWindow() = window(0, 0, 16, 16);
  write_test_file(path_,
                  {beauty, scanline_part(window(0, 0, 4, 4), {{"Z", Imf::FLOAT}}, Imf::PIZ_COMPRESSION)});
  const std::vector<std::string> expected = {
      "part 0 'part0': tiles of 16x8, ZIP, data window 20x10 at (-2, 3), display window 16x16 at (0, 0)",
      "  B           half   beauty.B",
      "  G           half   beauty.G",
      "  R           half   beauty.R",
      "  V.Vector.X  half   motion.X",
      "  V.Vector.Y  half   motion.Y negated",
      "  raw.U       uint   passed on",
      "part 1 'part1': scanlines, PIZ, data window 4x4 at (0, 0), display window 16x16 at (0, 0)",
      "  Z  float  depth.Z"};
  EXPECT_EQ(describe_exr(path_).lines(), expected);
  EXPECT_EQ(describe_exr(path_).problem, "");
}

TEST_F(ExrRead, DescriptionOfTwoEyes) {
  write_test_file(path_, {named_part("l", {{"R"}, {"G"}, {"B"}}, "left"),
                          named_part("r", {{"R"}, {"G"}, {"B"}, {"Z"}}, "right")});
  const std::vector<std::string> lines = describe_exr(path_).lines();
  EXPECT_NE(std::ranges::find(lines, "  G  half   left beauty.G"), lines.end());
  EXPECT_NE(std::ranges::find(lines, "  G  half   right beauty.G"), lines.end());
  EXPECT_NE(std::ranges::find(lines, "  Z  half   right depth.Z"), lines.end());
}

TEST_F(ExrRead, DescriptionOfACheckerboard) {
  for (const bool is_checkerboard : {true, false}) {
    Imf::Header header = scanline_part(window(0, 0, 4, 4), {{"R"}, {"G"}, {"B"}});
    header.insert("becalm:checkerboard", Imf::StringAttribute(is_checkerboard ? "odd" : "none"));
    write_test_file(path_, {header});
    EXPECT_EQ(describe_exr(path_).is_checkerboard, is_checkerboard);
    EXPECT_EQ(describe_exr(path_).lines().back().find("a checkerboard of pixels") == 0, is_checkerboard);
  }
}

TEST_F(ExrRead, AViewWithoutColourIsNone) {
  Imf::Header header = scanline_part(window(0, 0, 4, 4), {{"R"}, {"G"}, {"B"}, {"Z"}});
  header.insert("multiView", Imf::StringVectorAttribute({"left", "right"}));
  write_test_file(path_, {header});
  EXPECT_TRUE(read_exr(path_, 1, all_aovs()).other_views.empty());
}

TEST_F(ExrRead, DescriptionOfAFileWithoutColour) {
  write_test_file(path_, {scanline_part(window(0, 0, 4, 4), {{"Z", Imf::FLOAT}})});
  EXPECT_EQ(describe_exr(path_).lines().size(), 2u);
  EXPECT_NE(describe_exr(path_).problem.find("no colour"), std::string::npos);
}

TEST_F(ExrRead, NamesOfAnyBytesArePrintable) {
  write_test_file(path_,
                  {scanline_part(window(0, 0, 4, 4), {{"\x1b[2J\xff.R", Imf::FLOAT}, {"caf\xc3\xa9.R"}})});
  const ExrDescription description = describe_exr(path_);
  EXPECT_EQ(description.parts[0].channels[0].name, "\\x1b[2J\\xff.R");
  EXPECT_EQ(description.parts[0].channels[1].name, "caf\xc3\xa9.R");
  EXPECT_NE(description.problem.find("channels found: \\x1b[2J\\xff.R, caf"), std::string::npos)
      << description.problem;
}

TEST_F(ExrRead, ManyLongNamesAreCutShort) {
  std::vector<TestChannel> channels;
  channels.reserve(200);
  for (int i = 0; i < 200; ++i) channels.push_back({std::to_string(i) + std::string(200, 'x')});
  write_test_file(path_, {scanline_part(window(0, 0, 1, 1), channels)});
  const std::string problem = describe_exr(path_).problem;
  EXPECT_LT(problem.size(), 2500u);
  EXPECT_NE(problem.find("... and "), std::string::npos) << problem;
}

}  // namespace
}  // namespace becalm::io
