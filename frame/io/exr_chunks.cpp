#include <OpenEXR/ImfTileDescription.h>

#include <algorithm>
#include <stdexcept>

#include "frame/io/exr_bytes.h"
#include "frame/io/exr_file.h"

// OpenEXR tells that a file ends too early only by reading all of it.

namespace becalm::io {
namespace {

int lines_per_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 1;
  }
}

std::uint64_t divide_up(std::uint64_t size, std::uint64_t unit) {
  return (size + unit - 1) / unit;
}

/// Tiles along one side of each level that the side has.
std::vector<std::uint64_t> tiles_by_level(std::uint64_t size, std::uint64_t tile, std::uint64_t largest_size,
                                          const Imf::TileDescription& tiles) {
  const bool up = tiles.roundingMode == Imf::ROUND_UP;
  std::vector<std::uint64_t> counts;
  for (std::uint64_t unit = 1; counts.empty() || (up ? unit / 2 < largest_size : unit <= largest_size);
       unit *= 2) {
    const std::uint64_t level_size = up ? divide_up(size, unit) : size / unit;
    counts.push_back(divide_up(std::max<std::uint64_t>(level_size, 1), tile));
  }
  return counts;
}

/// Where the chunk that begins at `offset` ends: its place in the image, the sizes of its data, and the data.
std::uint64_t chunk_end(const ExrBytes& file, std::uint64_t offset, const Imf::Header& header,
                        bool multi_part) {
  if (multi_part) offset += sizeof(std::int32_t);  // the part's number
  offset += sizeof(std::int32_t) * (is_tiled(header) ? 4 : 1);
  if (!is_deep(header)) return offset + sizeof(std::int32_t) + file.read<std::uint32_t>(offset);
  const auto counts_size = file.read<std::uint64_t>(offset);
  const auto data_size = file.read<std::uint64_t>(offset + 8);
  if (std::max(counts_size, data_size) > (std::uint64_t{1} << 62))
    throw std::runtime_error("a chunk of absurd size");
  return offset + 24 + counts_size + data_size;
}

}  // namespace

std::uint64_t chunk_count(const Imf::Header& header) {
  const Imath::Box2i& window = header.dataWindow();
  const std::uint64_t width = window.max.x - window.min.x + 1;
  const std::uint64_t height = window.max.y - window.min.y + 1;
  if (!is_tiled(header)) return divide_up(height, lines_per_chunk(header.compression()));
  const Imf::TileDescription& tiles = header.tileDescription();
  const bool ripmap = tiles.mode == Imf::RIPMAP_LEVELS;
  const std::uint64_t largest = std::max(width, height);
  const auto across = tiles_by_level(width, tiles.xSize, ripmap ? width : largest, tiles);
  const auto down = tiles_by_level(height, tiles.ySize, ripmap ? height : largest, tiles);
  if (tiles.mode == Imf::ONE_LEVEL) return across[0] * down[0];
  std::uint64_t count = 0;
  for (std::size_t y = 0; y < down.size(); ++y) {
    for (std::size_t x = 0; x < across.size(); ++x) {
      if (ripmap || x == y) count += across[x] * down[y];
    }
  }
  return count;
}

void require_all_chunks(const std::string& path, const Imf::MultiPartInputFile& image) {
  const std::uint64_t file_size = stamp_of(path).size;
  const ExrBytes file(path);
  const bool multi_part = file.is_multi_part();
  std::uint64_t offset = file.headers_end();
  for (int part = 0; part < image.parts(); ++part) {
    const Imf::Header& header = image.header(part);
    const std::uint64_t count = chunk_count(header);
    for (std::uint64_t chunk = 0; chunk < count; ++chunk, offset += sizeof(std::uint64_t)) {
      const auto begin = file.read<std::uint64_t>(offset);
      // A writer fills the table in when all pixels are written.
      if (begin == 0) throw std::runtime_error("the file was not written to its end");
      if (begin >= file_size || chunk_end(file, begin, header, multi_part) > file_size) {
        throw std::runtime_error("the file ends before its pixels do");
      }
    }
  }
}

}  // namespace becalm::io
