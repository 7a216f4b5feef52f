#pragma once

#include <string>

#include "filter/gpu/image.h"
#include "frame/image.h"

namespace becalm::bench {

/// Files of raw little-endian floats with interleaved channels. Both throw an Error that names the file;
/// read_raw also if the file does not hold 1 to 4 channels of that extent.
Image read_raw(const std::string& path, gpu::Extent extent);
void write_raw(const std::string& path, const Image& image);

}  // namespace becalm::bench
