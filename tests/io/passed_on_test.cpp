#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

/// What write_denoised_exr passes on, and what it replaces.
class PassedOn : public ::testing::Test {
 protected:
  /// Reads `source_`, doubles the beauty, adds the diagnostics that are wanted, and writes `result_`.
  WriteReport denoise(AovSet diagnostics = {}, const LayerOverrides& overrides = {},
                      const DenoisedFormat& format = {}) {
    LoadedFrame loaded = read_exr(source_, 1, {}, {.layers = overrides});
    for (float& value : loaded.frame.image(Aov::beauty).data()) value = 2.0f * value + 1.0f;
    for (const AovInfo& entry : kAovTable) {
      if (diagnostics.test(static_cast<std::size_t>(entry.aov))) loaded.frame.add(entry.aov, 0.3f);
    }
    layers_ = loaded.layers;
    return write_denoised_exr(result_, loaded.frame, {}, loaded, {{"becalm:preset", "final"}}, format);
  }

  /// Every channel of the part has its bits, but for the named ones.
  void expect_same_but_for(const std::vector<std::string>& replaced, int part = 0) {
    const Planes before = read_planes(source_, part);
    const Planes after = read_planes(result_, part);
    for (const auto& [name, bytes] : before) {
      ASSERT_TRUE(after.contains(name)) << name;
      const bool is_replaced = std::find(replaced.begin(), replaced.end(), name) != replaced.end();
      EXPECT_EQ(after.at(name) == bytes, !is_replaced) << name;
    }
  }

  /// Header of the result equal to the source's, but for becalm's attributes, the channels and the named
  /// attributes.
  void expect_same_header(int part = 0, const std::vector<std::string>& but_for = {}) {
    const Imf::Header before = read_header(source_, part);
    const Imf::Header after = read_header(result_, part);
    for (auto it = before.begin(); it != before.end(); ++it) {
      const std::string name = it.name();
      if (name == "channels" || std::find(but_for.begin(), but_for.end(), name) != but_for.end()) continue;
      const Imf::Attribute* other = after.find(it.name()) == after.end() ? nullptr : &after[it.name()];
      ASSERT_NE(other, nullptr) << name;
      EXPECT_STREQ(other->typeName(), it.attribute().typeName()) << name;
      EXPECT_EQ(text_of(*other), text_of(it.attribute())) << name;
    }
    for (auto it = after.begin(); it != after.end(); ++it) {
      if (std::string_view(it.name()).starts_with("becalm:")) continue;
      EXPECT_TRUE(before.find(it.name()) != before.end()) << it.name() << " was added";
    }
  }

  static std::string text_of(const Imf::Attribute& attribute);

  TemporaryFolder folder_;
  const std::string source_ = folder_.path("source.exr");
  const std::string result_ = folder_.path("out/result.exr");
  LayerMap layers_;
};

/// Counts bytes of an attribute's value as it is stored in a file.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : OStream("memory") {}
  void write(const char* bytes, int size) override { bytes_.append(bytes, static_cast<std::size_t>(size)); }
  std::uint64_t tellp() override { return bytes_.size(); }
  void seekp(std::uint64_t) override {}
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string PassedOn::text_of(const Imf::Attribute& attribute) {
  MemoryStream stream;
  attribute.writeValueTo(stream, 2);
  return stream.bytes();
}

const std::vector<TestChannel> kMixed = {{"R"},
                                         {"G", Imf::FLOAT},
                                         {"B"},
                                         {"A", Imf::FLOAT},
                                         {"raw.half"},
                                         {"raw.float", Imf::FLOAT},
                                         {"raw.id", Imf::UINT},
                                         {"depth.Z", Imf::FLOAT}};
const std::vector<std::string> kBeauty = {"R", "G", "B", "A"};

void add_attributes_of_a_part(Imf::Header& header) {
  header.insert("cryptomatte/1a2b3c4/manifest", Imf::StringAttribute("{\"ball\":\"7fc12345\"}"));
  header.insert("cryptomatte/1a2b3c4/name", Imf::StringAttribute("CryptoObject"));
  header.insert("exposure", Imf::FloatAttribute(1.5f));
  Imf::addOwner(header, "somebody");
}

/// Those of a part, and the two that all parts of a file share.
void add_attributes(Imf::Header& header) {
  add_attributes_of_a_part(header);
  Imf::addChromaticities(header, Imf::Chromaticities());
  header.pixelAspectRatio() = 1.25f;
}

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
  denoise();
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

TEST_F(PassedOn, DenoisingAResultReplacesItsDiagnosticsAndAttributes) {
  write_test_file(source_,
                  {scanline_part(window(0, 0, 6, 4), {{"R"}, {"G"}, {"B"}, {"flow.X"}, {"flow.Y"}})});
  denoise(AovSet().set(static_cast<std::size_t>(Aov::flow)));
  EXPECT_EQ(read_header(result_).channels()["flow.X"].type, Imf::FLOAT);
  EXPECT_EQ(read_exr(result_, 1, AovSet().set()).frame.image(Aov::flow).at(5, 3, 0), 0.3f);
}

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
