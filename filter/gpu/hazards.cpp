#include "filter/gpu/hazards.h"

#include <algorithm>

namespace becalm::gpu {

bool HazardTracker::step(std::span<const MemoryAccess> accesses) {
  const auto conflicts = [&](const MemoryAccess& now) {
    return std::ranges::any_of(since_barrier_, [&](const MemoryAccess& before) {
      return now.arena == before.arena && now.begin < before.end && before.begin < now.end &&
             (now.writes || before.writes);
    });
  };
  const bool barrier = std::ranges::any_of(accesses, conflicts);
  if (barrier) since_barrier_.clear();
  since_barrier_.insert(since_barrier_.end(), accesses.begin(), accesses.end());
  return barrier;
}

}  // namespace becalm::gpu
