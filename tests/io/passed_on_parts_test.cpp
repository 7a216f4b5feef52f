// What is written for tiles, smaller levels and files of several parts.

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/passed_on_fixture.h"

namespace becalm::io {
namespace {

TEST_F(PassedOn, Tiles) {
  for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y, Imf::RANDOM_Y}) {
    Imf::Header header = tiled_part(window(-5, -7, 45, 400), kMixed, 16, 24);
    header.lineOrder() = order;
    write_test_file(source_, {header});
    denoise();
    expect_same_but_for(kBeauty);
    expect_same_header();
  }
}

TEST_F(PassedOn, OfMipmapsTheFullSize) {
  Imf::Header header = tiled_part(window(0, 0, 50, 40), kMixed, 16, 16, Imf::MIPMAP_LEVELS);
  header.setChunkCount(12 + 4 + 1 + 1 + 1 + 1);
  write_test_file(source_, {header});
  EXPECT_TRUE(denoise().full_size_only);
  expect_same_but_for(kBeauty);
  expect_same_header(0, {"tiles", "chunkCount"});
  EXPECT_EQ(read_header(result_).chunkCount(), 12);
  EXPECT_EQ(read_header(result_).tileDescription().mode, Imf::ONE_LEVEL);
}

TEST_F(PassedOn, APartThatCannotBeCopiedIsAFaultOfItsFile) {
  constexpr std::streamoff chunk = 12 + 4 * sizeof(float);  // part, y and size before four pixels
  write_test_file(source_, {scanline_part(window(0, 0, 4, 4), {{"R"}, {"G"}, {"B"}}),
                            scanline_part(window(0, 0, 4, 4), {{"Z", Imf::FLOAT}}, Imf::NO_COMPRESSION)});
  std::fstream file(source_, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(-chunk + 4, std::ios::end);
  const std::int32_t wrong_y = 77;
  file.write(reinterpret_cast<const char*>(&wrong_y), sizeof wrong_y);
  file.close();
  try {
    denoise();
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::bad_input) << error.what();
    EXPECT_TRUE(std::string(error.what()).starts_with(source_ + ": ")) << error.what();
  }
}

TEST_F(PassedOn, PartsKeepTheirChunks) {
  Imf::Header ids = scanline_part(
      window(-2, 0, 12, 100), {{"CryptoA.R", Imf::FLOAT}, {"CryptoB.G", Imf::FLOAT}}, Imf::PIZ_COMPRESSION);
  add_attributes_of_a_part(ids);
  write_test_file(source_, {ids, scanline_part(window(0, 0, 20, 30), kMixed),
                            tiled_part(window(0, 0, 33, 17), {{"N.X"}, {"N.Y"}, {"N.Z"}}, 8, 8,
                                       Imf::RIPMAP_LEVELS, Imf::B44_COMPRESSION),
                            scanline_part(window(0, 0, 21, 40), {{"light.R"}, {"light.G"}, {"light.B"}},
                                          Imf::DWAB_COMPRESSION)});
  denoise();
  EXPECT_EQ(layers_[0]->part, 1);
  expect_same_but_for({}, 0);
  expect_same_but_for(kBeauty, 1);
  expect_same_but_for({}, 2);
  expect_same_but_for({}, 3);
  for (int part = 0; part < 4; ++part) expect_same_header(part);
  EXPECT_EQ(read_attribute(result_, "becalm:preset"), "final") << "in the first part too";

  // Lossy parts can only be equal because their chunks were not decompressed; so are the smaller levels.
  Imf::MultiPartInputFile before(source_.c_str());
  Imf::MultiPartInputFile after(result_.c_str());
  Imf::TiledInputPart tiles_before(before, 2);
  Imf::TiledInputPart tiles_after(after, 2);
  int x = 0, y = 0, level_x = 2, level_y = 1, size_before = 0, size_after = 0;
  const char* bytes_before = nullptr;
  const char* bytes_after = nullptr;
  tiles_before.rawTileData(x, y, level_x, level_y, bytes_before, size_before);
  tiles_after.rawTileData(x, y, level_x, level_y, bytes_after, size_after);
  EXPECT_EQ(std::string(bytes_before, size_before), std::string(bytes_after, size_after));
}

TEST_F(PassedOn, AFileOfADeepPartAloneIsToldAsOne) {
  Imf::Header deep(window(0, 0, 2, 2), window(0, 0, 2, 2));
  deep.setType(Imf::DEEPSCANLINE);
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  std::vector<unsigned> counts(4, 0);
  std::vector<float*> pointers(4, nullptr);
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), 2 * sizeof(unsigned)));
  buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(float*),
                                    2 * sizeof(float*), sizeof(float)));
  {
    Imf::MultiPartOutputFile file(source_.c_str(), &deep, 1);
    Imf::DeepScanLineOutputPart out(file, 0);
    out.setFrameBuffer(buffer);
    out.writePixels(2);
  }
  EXPECT_EQ(describe_exr(source_, {}).problem, source_ + ": a deep image, expected flat pixels");
}

TEST_F(PassedOn, DeepParts) {
  constexpr int width = 6;
  constexpr int height = 40;
  const Imath::Box2i deep_window = window(0, 0, width, height);
  Imf::Header deep(deep_window, deep_window);
  deep.setName("deep");
  deep.setType(Imf::DEEPSCANLINE);
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  Imf::Header flat = scanline_part(deep_window, {{"R"}, {"G"}, {"B"}});
  flat.setName("flat");
  std::vector<unsigned> counts(width * height);
  std::vector<float> samples(width * height * 3);
  std::vector<float*> pointers(width * height);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = 0.5f * static_cast<float>(i);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = i % 4;
    pointers[i] = &samples[i * 3];
  }
  const auto buffer = [&] {
    Imf::DeepFrameBuffer result;
    result.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                             sizeof(unsigned), width * sizeof(unsigned)));
    result.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(float*),
                                      width * sizeof(float*), sizeof(float)));
    return result;
  };
  {
    const Imf::Header headers[] = {deep, flat};
    Imf::MultiPartOutputFile file(source_.c_str(), headers, 2);
    Imf::DeepScanLineOutputPart out(file, 0);
    out.setFrameBuffer(buffer());
    out.writePixels(height);
    std::vector<Imath::half> colour(width * height, Imath::half(0.5f));
    Imf::FrameBuffer pixels;
    for (const char* name : {"R", "G", "B"}) {
      pixels.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(colour.data()), 2, 2 * width));
    }
    Imf::OutputPart flat_out(file, 1);
    flat_out.setFrameBuffer(pixels);
    flat_out.writePixels(height);
  }
  for (const char* name : {"deep", "deep/Z", "beauty"})
    EXPECT_NO_THROW(check_selection(source_, {}, {.names = {name}}, "--channels")) << name;
  EXPECT_THROW(check_selection(source_, {}, {.names = {"deep/A"}}, "--channels"), Error);
  EXPECT_THROW(check_scaling(source_, {}), Error);
  EXPECT_THROW(check_scaling(source_, {.names = {"deep", "beauty"}}), Error);
  EXPECT_NO_THROW(check_scaling(source_, {.names = {"beauty"}}));
  denoise({}, {}, {.type = {}, .channels = {.names = {"deep", "beauty"}}});
  const std::vector<float> expected = samples;
  std::fill(samples.begin(), samples.end(), -1.0f);
  std::fill(counts.begin(), counts.end(), 9u);
  Imf::MultiPartInputFile file(result_.c_str());
  Imf::DeepScanLineInputPart in(file, 0);
  in.setFrameBuffer(buffer());
  in.readPixelSampleCounts(0, height - 1);
  in.readPixels(0, height - 1);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    ASSERT_EQ(counts[i], i % 4);
    for (std::size_t s = 0; s < counts[i]; ++s) EXPECT_EQ(samples[i * 3 + s], expected[i * 3 + s]);
  }
}

TEST_F(PassedOn, PartsAreSelectedByTheirNames) {
  Imf::Header albedo = scanline_part(window(0, 0, 4, 4), {{"R"}, {"G"}, {"B"}});
  albedo.setName("albedo");
  write_test_file(source_, {scanline_part(window(0, 0, 4, 4), kMixed), albedo});
  for (const char* name : {"albedo", "albedo/R"}) {
    EXPECT_NO_THROW(check_selection(source_, {}, {.names = {name}}, "--channels")) << name;
    const LoadedFrame loaded = read_exr(source_, 1, {});
    DenoisedFormat format;
    format.channels.names = {name};
    write_denoised_exr(result_, loaded.frame, {}, loaded, {}, format);
    const Imf::MultiPartInputFile result(result_.c_str());
    EXPECT_EQ(result.parts(), 1) << name;
    EXPECT_NE(result.header(0).channels().findChannel("R"), nullptr) << name;
    EXPECT_EQ(result.header(0).channels().findChannel("G") == nullptr, name == std::string("albedo/R"));
  }
  EXPECT_THROW(check_selection(source_, {}, {.names = {"albedo/A"}}, "--channels"), Error);
}

TEST_F(PassedOn, DiagnosticsAreAddedToTheBeautysPart) {
  write_test_file(source_, {scanline_part(window(0, 0, 4, 4), {{"id.U", Imf::UINT}}),
                            scanline_part(window(0, 0, 6, 4), kMixed)});
  AovSet diagnostics;
  diagnostics.set(static_cast<std::size_t>(Aov::flow));
  diagnostics.set(static_cast<std::size_t>(Aov::sample_count));
  denoise(diagnostics);
  expect_same_but_for({}, 0);
  expect_same_but_for(kBeauty, 1);
  const Imf::Header header = read_header(result_, 1);
  ASSERT_NE(header.channels().findChannel("flow.Y"), nullptr);
  EXPECT_EQ(header.channels()["sample_count.Y"].type, Imf::FLOAT);
  EXPECT_EQ(header.channels().findChannel("error_mask.Y"), nullptr);
  EXPECT_EQ(read_exr(result_, 1, AovSet().set()).frame.image(Aov::flow).at(5, 3, 1), 0.3f);
}

}  // namespace
}  // namespace becalm::io
