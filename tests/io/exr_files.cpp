#include "tests/io/exr_files.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputPart.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

namespace becalm::io {
namespace {

std::uint32_t hash(const std::string& channel, int x, int y) {
  std::uint32_t h = 2166136261u;
  const auto mix = [&h](std::uint32_t value) {
    h = (h ^ value) * 16777619u;
    h ^= h >> 15;
  };
  for (char c : channel) mix(static_cast<unsigned char>(c));
  mix(static_cast<std::uint32_t>(x));
  mix(static_cast<std::uint32_t>(y));
  mix(0x9e3779b9u);
  return h;
}

std::size_t size_of(Imf::PixelType type) {
  return type == Imf::HALF ? 2 : 4;
}

std::uint32_t bits_of(const std::string& channel, Imf::PixelType type, int x, int y) {
  const std::uint32_t h = hash(channel, x, y);
  if (channel.starts_with("Crypto") || channel.starts_with("raw")) {
    // Every seventh sample is one of the values that a conversion would lose.
    constexpr std::uint32_t hard32[] = {0x7fc12345u, 0xff800001u, 0x7f800000u, 0x80000000u, 0x00000001u};
    constexpr std::uint32_t hard16[] = {0x7e01u, 0xfc01u, 0x7c00u, 0x8000u, 0x0001u};
    if (h % 7 == 0) return type == Imf::HALF ? hard16[h / 7 % 5] : hard32[h / 7 % 5];
    return type == Imf::HALF ? h & 0xffffu : h;
  }
  const float value = test_value(channel, x, y);
  if (type == Imf::HALF) return Imath::half(value).bits();
  if (type == Imf::UINT) return static_cast<std::uint32_t>(value * 1000.0f);
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// The planes of one level, and the frame buffer that shows them to OpenEXR.
struct Pixels {
  Planes planes;
  Imf::FrameBuffer buffer;

  Pixels(const Imf::ChannelList& channels, const Imath::Box2i& window, bool fill) {
    for (auto it = channels.begin(); it != channels.end(); ++it) {
      const Imf::Channel& channel = it.channel();
      const int columns = (window.max.x - window.min.x) / channel.xSampling + 1;
      const int rows = (window.max.y - window.min.y) / channel.ySampling + 1;
      std::vector<char>& plane = planes[it.name()];
      plane.resize(static_cast<std::size_t>(columns) * rows * size_of(channel.type));
      for (int row = 0; row < rows && fill; ++row) {
        for (int column = 0; column < columns; ++column) {
          const std::uint32_t bits =
              bits_of(it.name(), channel.type, window.min.x + column * channel.xSampling,
                      window.min.y + row * channel.ySampling);
          std::memcpy(&plane[(static_cast<std::size_t>(row) * columns + column) * size_of(channel.type)],
                      &bits, size_of(channel.type));
        }
      }
      buffer.insert(it.name(),
                    Imf::Slice::Make(channel.type, plane.data(), window, size_of(channel.type),
                                     columns * size_of(channel.type), channel.xSampling, channel.ySampling));
    }
  }
};

void write_tiles(Imf::MultiPartOutputFile& file, int part) {
  Imf::TiledOutputPart out(file, part);
  for (int level_y = 0; level_y < out.numYLevels(); ++level_y) {
    for (int level_x = 0; level_x < out.numXLevels(); ++level_x) {
      if (!out.isValidLevel(level_x, level_y)) continue;
      const Pixels pixels(file.header(part).channels(), out.dataWindowForLevel(level_x, level_y), true);
      out.setFrameBuffer(pixels.buffer);
      out.writeTiles(0, out.numXTiles(level_x) - 1, 0, out.numYTiles(level_y) - 1, level_x, level_y);
    }
  }
}

void write_lines(Imf::MultiPartOutputFile& file, int part) {
  Imf::OutputPart out(file, part);
  const Imath::Box2i& window = file.header(part).dataWindow();
  const Pixels pixels(file.header(part).channels(), window, true);
  out.setFrameBuffer(pixels.buffer);
  out.writePixels(window.max.y - window.min.y + 1);
}

}  // namespace

Imath::Box2i window(int min_x, int min_y, int width, int height) {
  return {Imath::V2i(min_x, min_y), Imath::V2i(min_x + width - 1, min_y + height - 1)};
}

Imf::Header scanline_part(const Imath::Box2i& data_window, const std::vector<TestChannel>& channels,
                          Imf::Compression compression) {
  Imf::Header header(data_window, data_window);
  header.compression() = compression;
  header.setType(Imf::SCANLINEIMAGE);
  for (const TestChannel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.type, channel.sampling, channel.sampling));
  }
  return header;
}

Imf::Header tiled_part(const Imath::Box2i& data_window, const std::vector<TestChannel>& channels,
                       int tile_width, int tile_height, Imf::LevelMode mode, Imf::Compression compression) {
  Imf::Header header = scanline_part(data_window, channels, compression);
  header.setType(Imf::TILEDIMAGE);
  header.setTileDescription(Imf::TileDescription(tile_width, tile_height, mode));
  return header;
}

void write_test_file(const std::string& path, std::vector<Imf::Header> parts) {
  for (std::size_t part = 0; part < parts.size() && parts.size() > 1; ++part) {
    if (!parts[part].hasName()) parts[part].setName("part" + std::to_string(part));
    parts[part].displayWindow() = parts[0].displayWindow();
  }
  Imf::MultiPartOutputFile file(path.c_str(), parts.data(), static_cast<int>(parts.size()));
  for (int part = 0; part < file.parts(); ++part) {
    file.header(part).hasTileDescription() ? write_tiles(file, part) : write_lines(file, part);
  }
}

float test_value(const std::string& channel, int x, int y) {
  return static_cast<float>(hash(channel, x, y) % 2048u) / 1024.0f;
}

Planes read_planes(const std::string& path, int part) {
  Imf::MultiPartInputFile file(path.c_str());
  Imf::InputPart in(file, part);
  const Imath::Box2i& window = in.header().dataWindow();
  Pixels pixels(in.header().channels(), window, false);
  in.setFrameBuffer(pixels.buffer);
  in.readPixels(window.min.y, window.max.y);
  return std::move(pixels.planes);
}

Imf::Header read_header(const std::string& path, int part) {
  return Imf::MultiPartInputFile(path.c_str()).header(part);
}

std::string read_bytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::vector<TestChannel> layer_channels(const std::string& layer, const std::vector<std::string>& suffixes,
                                        Imf::PixelType type) {
  std::vector<TestChannel> channels;
  for (const std::string& suffix : suffixes) {
    channels.push_back({layer.empty() || suffix.empty() ? layer + suffix : layer + "." + suffix, type});
  }
  return channels;
}

std::vector<TestChannel> joined(const std::vector<std::vector<TestChannel>>& lists) {
  std::vector<TestChannel> channels;
  for (const std::vector<TestChannel>& list : lists)
    channels.insert(channels.end(), list.begin(), list.end());
  return channels;
}

Imf::Header named_part(const std::string& name, const std::vector<TestChannel>& channels,
                       const std::string& view) {
  Imf::Header header = scanline_part(window(0, 0, 8, 6), channels);
  header.setName(name);
  if (!view.empty()) header.setView(view);
  return header;
}

std::vector<TestChannel> blender_channels(const std::string& view_layer) {
  std::vector<TestChannel> channels;
  const auto add = [&](const std::string& layer, std::string_view letters, Imf::PixelType type) {
    const std::string prefix = view_layer + "." + layer + ".";
    for (char letter : letters) channels.push_back({prefix + letter, type});
  };
  add("Combined", "RGBA", Imf::HALF);
  add("Depth", "Z", Imf::FLOAT);
  add("Vector", "XYZW", Imf::HALF);
  add("Denoising Albedo", "RGB", Imf::HALF);
  add("Denoising Normal", "XYZ", Imf::HALF);
  add("Denoising Depth", "Z", Imf::FLOAT);
  for (char letter : std::string_view("RGBA")) {
    channels.push_back({std::string("CryptoObject00.") + letter, Imf::FLOAT});
  }
  return channels;
}

}  // namespace becalm::io
