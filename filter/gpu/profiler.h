#pragma once

#include <cstdint>
#include <string>

namespace becalm::gpu {

/// Device time of one pass, from timestamps; 0 if the device has none. For a host pass: host time.
struct PassTime {
  std::string name;  ///< kernel or host pass, and the first image it writes: `align/downsample luma.cur.L1`
  double milliseconds = 0.0;
  std::uint64_t image_bytes = 0;  ///< size of all images that it binds, each counted once
};

}  // namespace becalm::gpu
