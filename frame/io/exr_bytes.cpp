#include "frame/io/exr_bytes.h"

#include <OpenEXR/ImfVersion.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <map>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace becalm::io {
namespace {

static_assert(std::endian::native == std::endian::little, "integers are copied as they are stored");

constexpr std::uint32_t kMultiPartFlag = 0x1000;
constexpr std::uint64_t kFirstHeader = 8;   // behind the magic number and the version
constexpr std::uint64_t kChannelSize = 16;  // type, linearity, sampling; behind the name

/// Bytes that OpenEXR reads of an attribute of this type, whatever the file says.
const std::map<std::string_view, std::uint64_t>& fixed_sizes() {
  static const std::map<std::string_view, std::uint64_t> sizes = {
      {"box2f", 16},
      {"box2i", 16},
      {"chromaticities", 32},
      {"compression", 1},
      {"deepImageState", 1},
      {"double", 8},
      {"envmap", 1},
      {"float", 4},
      {"int", 4},
      {"keycode", 28},
      {"lineOrder", 1},
      {"m33d", 72},
      {"m33f", 36},
      {"m44d", 128},
      {"m44f", 64},
      {"rational", 8},
      {"tiledesc", 9},
      {"timecode", 8},
      {"v2d", 16},
      {"v2f", 8},
      {"v2i", 8},
      {"v3d", 24},
      {"v3f", 12},
      {"v3i", 12},
  };
  return sizes;
}

[[noreturn]] void throw_bad_size(const std::string& type) {
  throw std::runtime_error("the size of an attribute of type '" + type + "' is not that of its value");
}

}  // namespace

ExrBytes::ExrBytes(const std::string& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category());
}

ExrBytes::~ExrBytes() {
  ::close(descriptor_);
}

bool ExrBytes::load(std::uint64_t offset, std::size_t count) const {
  if (offset >= block_offset_ && offset + count <= block_offset_ + block_size_) return true;
  const ssize_t got = ::pread(descriptor_, block_.data(), block_.size(), static_cast<off_t>(offset));
  // A damaged file may name an offset beyond those of any file.
  if (got < 0 && errno != EINVAL) throw std::system_error(errno, std::generic_category());
  block_offset_ = offset;
  block_size_ = static_cast<std::size_t>(std::max<ssize_t>(got, 0));
  return block_size_ >= count;
}

const char* ExrBytes::bytes(std::uint64_t offset, std::size_t count) const {
  if (!load(offset, count)) throw std::runtime_error("the file ends too early");
  return block_.data() + (offset - block_offset_);
}

bool ExrBytes::is_exr() const {
  return load(0, kFirstHeader) && Imf::isImfMagic(block_.data());
}

bool ExrBytes::is_multi_part() const {
  return (read<std::uint32_t>(4) & kMultiPartFlag) != 0;
}

std::uint64_t ExrBytes::headers_end() const {
  if (!is_multi_part()) return header_end(kFirstHeader);
  std::uint64_t offset = kFirstHeader;
  while (read<char>(offset) != '\0') offset = header_end(offset);
  return offset + 1;
}

/// The name that ends with a zero; moves behind that.
std::string ExrBytes::name(std::uint64_t& offset) const {
  std::string name;
  while (const char c = read<char>(offset++)) name += c;
  return name;
}

/// Walks over one header, attribute by attribute: name, type, size, value. An empty name ends it.
std::uint64_t ExrBytes::header_end(std::uint64_t offset) const {
  while (!name(offset).empty()) {
    const std::string type = name(offset);
    const std::uint64_t size = read<std::uint32_t>(offset);
    offset += sizeof(std::uint32_t);
    if (size > 0) read<char>(offset + size - 1);
    require_value(type, offset, size);
    offset += size;
  }
  return offset;
}

/// Checks types whose size OpenEXR takes from within the value: it allocates that much before it reads, and
/// it would then look for the next attribute at another place than this class.
void ExrBytes::require_value(const std::string& type, std::uint64_t offset, std::uint64_t size) const {
  const std::uint64_t end = offset + size;
  if (const auto found = fixed_sizes().find(type); found != fixed_sizes().end()) {
    if (size != found->second) throw_bad_size(type);
  } else if (type == "chlist") {
    while (!name(offset).empty()) offset += kChannelSize;
    if (offset != end) throw_bad_size(type);
  } else if (type == "preview") {
    const std::uint64_t pixels = std::uint64_t{read<std::uint32_t>(offset)} * read<std::uint32_t>(offset + 4);
    if (size != 8 + 4 * pixels) throw_bad_size(type);
  } else if (type == "stringvector") {
    while (offset < end) offset += sizeof(std::uint32_t) + read<std::uint32_t>(offset);
    if (offset != end) throw_bad_size(type);
  }
}

}  // namespace becalm::io
