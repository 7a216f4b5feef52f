#pragma once

#include <string>

#include "filter/gpu/image.h"
#include "frame/image.h"

namespace becalm::bench {

/// Files of raw little-endian floats, interleaved. Both throw Error, which names the file; reading does so
/// unless the file holds 1 to 4 channels of that extent.
Image read_raw(const std::string& path, gpu::Extent extent);
void write_raw(const std::string& path, const Image& image);

}  // namespace becalm::bench
