#include <OpenEXR/ImfTileDescription.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "frame/io/exr_file.h"

// The file layout that this follows: "OpenEXR File Layout", openexr.com. Neither of OpenEXR's interfaces can
// tell that a file ends too early without reading all of it.

namespace becalm::io {
namespace {

constexpr std::uint32_t kMultiPartFlag = 0x1000;

class FileBytes {
 public:
  explicit FileBytes(const std::string& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  /// Integers are stored with their lowest byte first, as this processor has them.
  template <class T>
  T read(std::uint64_t offset) const {
    static_assert(std::endian::native == std::endian::little);
    if (offset < block_offset_ || offset + sizeof(T) > block_offset_ + block_size_) {
      block_offset_ = offset;
      block_size_ = std::max<ssize_t>(
          ::pread(descriptor_, block_.data(), block_.size(), static_cast<off_t>(offset)), 0);
      if (block_size_ < sizeof(T)) throw std::runtime_error("the file ends too early");
    }
    T value;
    std::memcpy(&value, block_.data() + (offset - block_offset_), sizeof value);
    return value;
  }

 private:
  int descriptor_;
  mutable std::array<char, 4096> block_{};  // what was read last
  mutable std::uint64_t block_offset_ = 0;
  mutable std::size_t block_size_ = 0;
};

/// Walks over a name with its final zero.
std::uint64_t skip_name(const FileBytes& file, std::uint64_t offset) {
  while (file.read<char>(offset) != '\0') ++offset;
  return offset + 1;
}

/// Walks over one header, attribute by attribute: name, type, size, value. An empty name ends it.
std::uint64_t skip_header(const FileBytes& file, std::uint64_t offset) {
  while (file.read<char>(offset) != '\0') {
    offset = skip_name(file, skip_name(file, offset));
    offset += sizeof(std::int32_t) + file.read<std::uint32_t>(offset);
  }
  return offset + 1;
}

bool is_multi_part(const FileBytes& file) {
  return (file.read<std::uint32_t>(4) & kMultiPartFlag) != 0;
}

/// Walks over the magic number, the version and the headers of all parts, which an empty header ends.
std::uint64_t skip_headers(const FileBytes& file) {
  std::uint64_t offset = 8;
  if (!is_multi_part(file)) return skip_header(file, offset);
  while (file.read<char>(offset) != '\0') offset = skip_header(file, offset);
  return offset + 1;
}

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
std::uint64_t chunk_end(const FileBytes& file, std::uint64_t offset, const Imf::Header& header,
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

void require_whole_headers(const std::string& path) {
  skip_headers(FileBytes(path));
}

void require_all_chunks(const std::string& path, const Imf::MultiPartInputFile& image) {
  const std::uint64_t file_size = stamp_of(path).size;
  const FileBytes file(path);
  const bool multi_part = is_multi_part(file);
  std::uint64_t offset = skip_headers(file);
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
