#pragma once

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPixelType.h>
#include <OpenEXR/ImfTileDescription.h>

#include <map>
#include <string>
#include <vector>

namespace becalm::io {

/// Files for tests, written through OpenEXR's own interface so that they owe nothing to the code under test.
struct TestChannel {
  std::string name;
  Imf::PixelType type = Imf::HALF;
  int sampling = 1;
};

Imath::Box2i window(int min_x, int min_y, int width, int height);

/// A scanline part whose display window is its data window.
Imf::Header scanline_part(const Imath::Box2i& data_window, const std::vector<TestChannel>& channels,
                          Imf::Compression compression = Imf::ZIP_COMPRESSION);
Imf::Header tiled_part(const Imath::Box2i& data_window, const std::vector<TestChannel>& channels,
                       int tile_width, int tile_height, Imf::LevelMode mode = Imf::ONE_LEVEL,
                       Imf::Compression compression = Imf::ZIP_COMPRESSION);

/// `layer.SUFFIX` for each suffix; bare channels for an empty layer.
std::vector<TestChannel> layer_channels(const std::string& layer, const std::vector<std::string>& suffixes,
                                        Imf::PixelType type = Imf::FLOAT);
std::vector<TestChannel> joined(const std::vector<std::vector<TestChannel>>& lists);
/// A scanline part of 8x6 pixels with a name of its own, of an eye if `view` names one.
Imf::Header named_part(const std::string& name, const std::vector<TestChannel>& channels,
                       const std::string& view = "");

/// Writes parts of these headers. Channels whose name begins with `Crypto` or `raw` hold arbitrary bits,
/// infinities and NaNs among them; others hold values in [0, 2). Parts of a file of several that have
/// no name are named `part0`, `part1` ...
void write_test_file(const std::string& path, std::vector<Imf::Header> parts);

/// The value that write_test_file gave a channel's pixel, before it was rounded to the channel's type.
float test_value(const std::string& channel, int x, int y);

/// The bytes of each channel of a part's largest level, rows of the channel's own type from the top left.
using Planes = std::map<std::string, std::vector<char>>;
Planes read_planes(const std::string& path, int part = 0);

Imf::Header read_header(const std::string& path, int part = 0);

std::string read_bytes(const std::string& path);
void write_bytes(const std::string& path, const std::string& bytes);

/// The channels of a Blender render: Combined, Depth, Vector, denoising passes and Cryptomatte.
std::vector<TestChannel> blender_channels(const std::string& view_layer);

}  // namespace becalm::io
