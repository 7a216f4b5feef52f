#pragma once

#include <string>

namespace becalm::gpu {

/// Device time of one pass, from timestamps; 0 where the device has none.
struct PassTime {
  std::string name;  ///< kernel and the first image it writes: `align/downsample luma.cur.L1`
  double milliseconds = 0.0;
};

}  // namespace becalm::gpu
