// What is written for a single part: its channels, types, compressions and attributes.

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/passed_on_fixture.h"

namespace becalm::io {
namespace {

TEST_F(PassedOn, ChannelsAttributesWindowsAndTypes) {
  Imf::Header header = scanline_part(window(-9, 4, 31, 27), kMixed);
  header.displayWindow() = window(0, 0, 20, 64);
  add_attributes(header);
  write_test_file(source_, {header});
  const WriteReport report = denoise();
  EXPECT_FALSE(report.lossless_instead);
  EXPECT_FALSE(report.full_size_only);
  expect_same_but_for(kBeauty);
  expect_same_header();
  const Imf::Header after = read_header(result_);
  for (const TestChannel& channel : kMixed) EXPECT_EQ(after.channels()[channel.name].type, channel.type);
  EXPECT_EQ(read_attribute(result_, "becalm:preset"), "final");
}

TEST_F(PassedOn, TheBeautyIsReplacedInItsOwnTypes) {
  write_test_file(source_, {scanline_part(window(0, 0, 5, 300), kMixed)});
  denoise();
  const Planes planes = read_planes(result_);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 5; ++x) {
      Imath::half red;
      float green;
      std::memcpy(&red, &planes.at("R")[(y * 5 + x) * 2], 2);
      std::memcpy(&green, &planes.at("G")[(y * 5 + x) * 4], 4);
      EXPECT_EQ(red.bits(), Imath::half(2.0f * test_value("R", x, y) + 1.0f).bits());
      EXPECT_EQ(green, 2.0f * test_value("G", x, y) + 1.0f);
    }
  }
}

TEST_F(PassedOn, WhatIsToldOfCryptomattesGoesWithTheirChannels) {
  Imf::Header header = scanline_part(window(0, 0, 8, 6), blender_channels("V"));
  add_attributes(header);
  write_test_file(source_, {header});
  const LoadedFrame loaded = read_exr(source_, 1, {});
  for (const auto& [name, stays] :
       {std::pair{"beauty", false}, {"CryptoObject00", true}, {"CryptoObject00.R", true}}) {
    DenoisedFormat format;
    format.channels.names = {name};
    write_denoised_exr(result_, loaded.frame, {}, loaded, {}, format);
    const Imf::Header after = read_header(result_);
    for (const char* told : {"cryptomatte/1a2b3c4/manifest", "cryptomatte/1a2b3c4/name"})
      EXPECT_EQ(after.find(told) != after.end(), stays) << name << ' ' << told;
    EXPECT_TRUE(after.find("exposure") != after.end()) << name;
  }
}

TEST_F(PassedOn, EveryCompressionKeepsTheBits) {
  for (int i = 0; i < Imf::NUM_COMPRESSION_METHODS; ++i) {
    const Imf::Compression compression = static_cast<Imf::Compression>(i);
    write_test_file(source_, {scanline_part(window(0, 0, 37, 70), kMixed, compression)});
    const bool b44 = compression == Imf::B44_COMPRESSION || compression == Imf::B44A_COMPRESSION;
    // DWA transforms colours alone, and no colour but the beauty's is here.
    EXPECT_EQ(denoise().lossless_instead, b44) << i;
    expect_same_but_for(kBeauty);
    EXPECT_EQ(read_header(result_).compression(), b44 ? Imf::ZIP_COMPRESSION : compression);
  }
}

TEST_F(PassedOn, LossyColoursOfOtherLayersAreKeptByZip) {
  std::vector<TestChannel> channels = kMixed;
  channels.push_back({"light.R"});
  channels.push_back({"light.g", Imf::FLOAT});
  for (const Imf::Compression compression : {Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
    write_test_file(source_, {scanline_part(window(0, 0, 37, 70), channels, compression)});
    EXPECT_TRUE(denoise().lossless_instead);
    expect_same_but_for(kBeauty);
    expect_same_header(0, {"compression"});
  }
}

TEST_F(PassedOn, TypesOfTheDenoisedChannelsOnRequest) {
  write_test_file(source_, {scanline_part(window(0, 0, 20, 30), kMixed)});
  for (const auto& [type, expected] :
       {std::pair{PixelType::half, Imf::HALF}, {PixelType::float32, Imf::FLOAT}}) {
    denoise(AovSet().set(static_cast<std::size_t>(Aov::gain)), {}, {.type = type});
    expect_same_but_for(kBeauty);
    const Imf::Header after = read_header(result_);
    for (const std::string& name : kBeauty) EXPECT_EQ(after.channels()[name].type, expected) << name;
    EXPECT_EQ(after.channels()["gain.Y"].type, Imf::FLOAT);
    EXPECT_EQ(after.channels()["raw.half"].type, Imf::HALF);
  }
}

TEST_F(PassedOn, AlphaThatIsKeptHasItsTypeAndItsBits) {
  for (const Imf::PixelType alpha : {Imf::HALF, Imf::FLOAT}) {
    write_test_file(source_, {scanline_part(window(0, 0, 37, 70), {{"R"}, {"G"}, {"B"}, {"A", alpha}})});
    LoadedFrame loaded = read_exr(source_, 1, {});
    for (std::size_t i = 0; i < loaded.frame.image(Aov::beauty).data().size(); ++i)
      if (i % 4 != 3) loaded.frame.image(Aov::beauty).data()[i] *= 0.5f;
    for (const std::string name : {"pxr24", "b44", "dwaa"}) {
      const DenoisedFormat format{.type = PixelType::half, .compression = name, .keeps_alpha = true};
      const WriteReport report = write_denoised_exr(result_, loaded.frame, {}, loaded, {}, format);
      const bool alters = alpha == Imf::HALF ? name == "b44" : name == "pxr24";
      EXPECT_EQ(report.lossless_instead, alters) << name;
      expect_same_but_for({"R", "G", "B"});
      EXPECT_EQ(read_header(result_).channels()["A"].type, alpha) << name;
    }
  }
}

TEST_F(PassedOn, CompressionOnRequestUnlessItWouldAlterOtherChannels) {
  for (const std::string_view name : compression_names()) {
    write_test_file(source_, {scanline_part(window(0, 0, 37, 70), kMixed)});
    const WriteReport report = denoise({}, {}, {.type = {}, .compression = std::string(name)});
    const bool alters = name == "b44" || name == "b44a" || name == "pxr24";  // half and float channels
    EXPECT_EQ(report.lossless_instead, alters) << name;
    expect_same_but_for(kBeauty);
    const auto index = std::ranges::find(compression_names(), name) - compression_names().begin();
    EXPECT_EQ(read_header(result_).compression(),
              alters ? Imf::ZIP_COMPRESSION : static_cast<Imf::Compression>(index))
        << name;
  }
}

TEST_F(PassedOn, ALossyBeautyAloneStaysLossy) {
  write_test_file(source_,
                  {scanline_part(window(0, 0, 16, 16), {{"R"}, {"G"}, {"B"}}, Imf::B44_COMPRESSION)});
  EXPECT_FALSE(denoise().lossless_instead);
  expect_same_header();
}

TEST_F(PassedOn, LineOrders) {
  for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
    Imf::Header header = scanline_part(window(3, -100, 9, 600), kMixed);
    header.lineOrder() = order;
    write_test_file(source_, {header});
    denoise();
    expect_same_but_for(kBeauty);
    expect_same_header();
  }
}

TEST_F(PassedOn, SubsampledChannels) {
  std::vector<TestChannel> channels = kMixed;
  channels.push_back({"raw.chroma", Imf::HALF, 2});
  write_test_file(source_, {scanline_part(window(-4, 2, 22, 300), channels)});
  denoise();
  expect_same_but_for(kBeauty);
}

TEST_F(PassedOn, BlenderWithCryptomatte) {
  Imf::Header header = scanline_part(window(0, 0, 40, 30), blender_channels("ViewLayer"));
  add_attributes(header);
  write_test_file(source_, {header});
  denoise();
  expect_same_but_for(
      {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Combined.A"});
  expect_same_header();
}

TEST_F(PassedOn, ChannelsThatDiagnosticsReplaceAreTold) {
  const AovSet flow = AovSet().set(static_cast<std::size_t>(Aov::flow));
  std::vector<TestChannel> channels = kMixed;
  write_test_file(source_, {scanline_part(window(0, 0, 12, 8), channels)});
  EXPECT_FALSE(denoise(flow).diagnostics_replace);
  channels.push_back({"flow.X", Imf::FLOAT});
  Imf::Header header = scanline_part(window(0, 0, 12, 8), channels);
  write_test_file(source_, {header});
  EXPECT_TRUE(denoise(flow).diagnostics_replace);
  EXPECT_FALSE(denoise().diagnostics_replace);
  header.insert("becalm:version", Imf::StringAttribute("0.1.0"));
  write_test_file(source_, {header});
  EXPECT_FALSE(denoise(flow).diagnostics_replace) << "becalm's own";
}

TEST_F(PassedOn, DenoisingAResultReplacesItsDiagnosticsAndAttributes) {
  write_test_file(source_,
                  {scanline_part(window(0, 0, 6, 4), {{"R"}, {"G"}, {"B"}, {"flow.X"}, {"flow.Y"}})});
  denoise(AovSet().set(static_cast<std::size_t>(Aov::flow)));
  EXPECT_EQ(read_header(result_).channels()["flow.X"].type, Imf::FLOAT);
  EXPECT_EQ(read_exr(result_, 1, AovSet().set()).frame.image(Aov::flow).at(5, 3, 0), 0.3f);
}

TEST_F(PassedOn, OverHalfsRangeIsCounted) {
  write_test_file(source_, {scanline_part(window(0, 0, 3, 1), {{"R"}, {"G", Imf::FLOAT}, {"B", Imf::UINT}})});
  LoadedFrame loaded = read_exr(source_, 1, {});
  for (float& value : loaded.frame.image(Aov::beauty).data()) value = 1e20f;
  EXPECT_EQ(write_denoised_exr(result_, loaded.frame, {}, loaded, {}).half_overflows, 3u);
  const Image beauty = read_exr(result_, 1, {}).frame.image(Aov::beauty);
  EXPECT_EQ(beauty.at(2, 0, 0), 65504.0f);
  EXPECT_EQ(beauty.at(2, 0, 1), 1e20f);
  EXPECT_EQ(beauty.at(2, 0, 2), 4294967295.0f);
}

TEST_F(PassedOn, TheSourceMayBeOverwritten) {
  write_test_file(source_, {scanline_part(window(0, 0, 6, 300), kMixed)});
  const Planes before = read_planes(source_);
  const LoadedFrame loaded = read_exr(source_, 1, {});
  write_denoised_exr(source_, loaded.frame, {}, loaded, {});
  EXPECT_EQ(read_planes(source_), before);
}

TEST_F(PassedOn, AChangedSourceIsAnError) {
  write_test_file(source_, {scanline_part(window(0, 0, 6, 4), kMixed)});
  const LoadedFrame loaded = read_exr(source_, 1, {});
  write_test_file(source_, {scanline_part(window(0, 0, 6, 5), kMixed)});
  try {
    write_denoised_exr(result_, loaded.frame, {}, loaded, {});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::bad_input);
    EXPECT_EQ(std::string(error.what()),
              source_ + ": changed after it was read; its other channels cannot be passed on");
  }
  EXPECT_EQ(folder_.file_count(), 1u);
}

}  // namespace
}  // namespace becalm::io
