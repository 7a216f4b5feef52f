#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace becalm::gpu {

/// An image's need: bytes, and the first and last pass that touch it (inclusive).
struct MemoryRequest {
  std::uint64_t bytes = 0;
  int first_pass = 0;
  int last_pass = 0;
};

struct MemoryPlan {
  std::vector<std::uint64_t> offsets;  ///< one a request, multiples of the alignment
  std::uint64_t total_bytes = 0;       ///< peak of the plan
};

/// Places the requests in one arena so that those whose lifetimes meet never overlap. Greedy by size: the largest first,
/// each at the lowest offset that is free. Pure arithmetic, no device types. `alias` false: all apart.
MemoryPlan plan_memory(std::span<const MemoryRequest> requests, std::uint64_t alignment, bool alias = true);

}  // namespace becalm::gpu
