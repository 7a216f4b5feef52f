// Bands of rows: a pass whose results do not fit in storage buffers is dispatched once for each band.

#include <algorithm>
#include <cstring>

#include "filter/gpu/chain_impl.h"

namespace becalm::gpu {

namespace {

/// Bands have a multiple of so many rows, so that they begin at offsets that every device can bind: Vulkan
/// allows no minStorageBufferOffsetAlignment above 256 bytes, and an element has at least 4.
constexpr std::uint64_t kRowsOfBands = 64;

}  // namespace

int rows_of_band(const PassDeclaration& pass, const std::vector<ImageDeclaration>& images,
                 std::uint64_t limit_bytes, const std::string& where) {
  const int height = pass.extent->height;
  if (!pass.kernel->first_row_offset) return height;
  std::uint64_t row_bytes = 1;
  for (const Use& use : pass.uses) {
    if (!use.writes()) continue;
    const ImageDeclaration& image = images[static_cast<std::size_t>(use.image)];
    if (image.extent != *pass.extent || image.extent.planes != 1) {
      throw DeviceError(where + "image '" + image.name + "' is written row by row, and is not one plane of " +
                        "the dispatch's size");
    }
    row_bytes = std::max(row_bytes, image.bytes() / static_cast<std::uint64_t>(height));
  }
  const std::uint64_t rows = limit_bytes / row_bytes;
  if (rows >= static_cast<std::uint64_t>(height)) return height;
  return static_cast<int>(std::max(rows / kRowsOfBands, std::uint64_t{1}) * kRowsOfBands);
}

BufferPart part_of_band(const PassDeclaration& pass, const Use& use, const ImageDeclaration& image,
                        int band) {
  if (use.plane) return {static_cast<std::uint64_t>(*use.plane) * image.plane_bytes(), image.plane_bytes()};
  if (!pass.kernel->first_row_offset || !use.writes()) return {0, image.bytes()};
  const std::uint64_t row_bytes = image.bytes() / static_cast<std::uint64_t>(image.extent.height);
  return {static_cast<std::uint64_t>(pass.first_row(band)) * row_bytes,
          static_cast<std::uint64_t>(pass.rows(band)) * row_bytes};
}

std::vector<std::byte> push_constants_of_band(const PassDeclaration& pass, int band) {
  std::vector<std::byte> result = pass.push_constants;
  if (const auto& offset = pass.kernel->first_row_offset) {
    const std::int32_t first_row = pass.first_row(band);
    std::memcpy(result.data() + *offset, &first_row, sizeof(first_row));
  }
  return result;
}

}  // namespace becalm::gpu
