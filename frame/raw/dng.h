#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "frame/mosaic.h"
#include "frame/raw/raw.h"

namespace becalm::raw {

/// Samples of a mosaic as a DNG file has them.
struct DngSamples {
  std::span<const std::uint16_t> values;
  std::uint16_t black = 0;
  std::uint16_t white = 65535;
};

/// The bytes of an uncompressed DNG file of one mosaic with what `info` tells; that is a TIFF file, too.
std::vector<std::byte> dng_bytes(const Info& info, const DngSamples& samples);

/// Samples of 16 bits: black is 4096, so that noise below it is kept, and white 65535, to which values above
/// it are cut.
constexpr std::uint16_t kDngBlack = 4096;
std::vector<std::uint16_t> quantized(const Mosaic& mosaic);

/// Writes a mosaic as DNG beside its place and renames it. Throws Error(resource) naming the path.
void write_dng(const std::string& path, const Mosaic& mosaic, const Info& info);

}  // namespace becalm::raw
