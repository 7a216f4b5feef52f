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

/// Writes a mosaic as DNG beside its place and renames it. Throws Error(resource) naming the path.
void write_dng(const std::string& path, const Mosaic& mosaic, const Info& info);

}  // namespace becalm::raw
