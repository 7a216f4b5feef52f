#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace becalm::gpu {

/// Bytes of device memory that one step of a chain reads or writes.
struct MemoryAccess {
  int arena = 0;
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  bool writes = false;
};

/// Decides where a chain needs barriers. It compares memory ranges, not images, so it also finds conflicts
/// between images that share memory. Pure arithmetic, no device types.
class HazardTracker {
 public:
  /// Adds the accesses of the next step. Returns true if they conflict (read after write, write after read,
  /// write after write) with a step since the last barrier: a full barrier must come before this step.
  bool step(std::span<const MemoryAccess> accesses);

 private:
  std::vector<MemoryAccess> since_barrier_;
};

}  // namespace becalm::gpu
