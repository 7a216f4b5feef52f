#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace becalm::gpu {

/// Memory that an image needs: its bytes, and the first and last step that use it (inclusive).
struct MemoryRequest {
  std::uint64_t bytes = 0;
  int first_pass = 0;
  int last_pass = 0;
};

struct MemoryPlan {
  std::vector<std::uint64_t> offsets;      ///< one per request, within its arena, multiples of the alignment
  std::vector<int> arenas;                 ///< one per request, an index into arena_bytes
  std::vector<std::uint64_t> arena_bytes;  ///< one arena unless the limit requires more
  std::uint64_t total_bytes = 0;           ///< of all arenas: the peak of the plan
};

/// Places the requests so that those whose lifetimes overlap never share memory. Greedy by size: the largest
/// first, each at the lowest offset that is free in the first arena where it ends below `max_arena_bytes`.
/// Pure arithmetic, no device types. If `alias` is false, no requests share memory. Throws
/// std::invalid_argument for a request that is larger than the limit or ends before it begins.
MemoryPlan plan_memory(std::span<const MemoryRequest> requests, std::uint64_t alignment, bool alias = true,
                       std::uint64_t max_arena_bytes = std::numeric_limits<std::uint64_t>::max());

}  // namespace becalm::gpu
