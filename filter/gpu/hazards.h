#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace becalm::gpu {

/// Bytes of device memory that one step of a chain touches.
struct MemoryAccess {
  int arena = 0;
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  bool writes = false;
};

/// Decides where a chain needs barriers. It sees memory, not images, so that two images that share memory are
/// told apart from one image no more than they should be. Pure arithmetic, no device types.
class HazardTracker {
 public:
  /// Notes the accesses of the next step. True if they conflict (read after write, write after read, write
  /// after write) with a step since the last barrier: a full barrier must come before this step.
  bool step(std::span<const MemoryAccess> accesses);

 private:
  std::vector<MemoryAccess> since_barrier_;
};

}  // namespace becalm::gpu
