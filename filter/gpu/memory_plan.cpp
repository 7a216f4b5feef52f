#include "filter/gpu/memory_plan.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>

namespace becalm::gpu {

namespace {

struct Placed {
  std::uint64_t begin;
  std::uint64_t end;
  int first_pass;
  int last_pass;
};

/// Lowest offset at which `bytes` fit between the placed requests that live at the same time.
std::uint64_t lowest_free_offset(const std::vector<Placed>& arena, const MemoryRequest& request,
                                 std::uint64_t bytes, bool alias) {
  std::uint64_t offset = 0;
  for (const Placed& other : arena) {  // in order of `begin`
    const bool meets =
        !alias || (other.first_pass <= request.last_pass && request.first_pass <= other.last_pass);
    if (!meets) continue;
    if (offset + bytes <= other.begin) break;
    offset = std::max(offset, other.end);
  }
  return offset;
}

}  // namespace

MemoryPlan plan_memory(std::span<const MemoryRequest> requests, std::uint64_t alignment, bool alias,
                       std::uint64_t max_arena_bytes) {
  if (alignment == 0) throw std::invalid_argument("plan_memory: alignment must be positive");
  std::vector<std::size_t> by_size(requests.size());
  std::iota(by_size.begin(), by_size.end(), std::size_t{0});
  std::ranges::stable_sort(by_size, std::greater{}, [&](std::size_t i) { return requests[i].bytes; });

  MemoryPlan plan;
  plan.offsets.resize(requests.size());
  plan.arenas.resize(requests.size());
  std::vector<std::vector<Placed>> arenas;
  for (const std::size_t i : by_size) {
    const MemoryRequest& request = requests[i];
    // Sizes rounded up to the alignment keep every offset a multiple of it.
    const std::uint64_t bytes = (request.bytes + alignment - 1) / alignment * alignment;
    if (bytes > max_arena_bytes || request.first_pass > request.last_pass) {
      throw std::invalid_argument("plan_memory: request " + std::to_string(i) +
                                  " is larger than an arena, or ends before it begins");
    }
    std::size_t arena = 0;
    std::uint64_t offset = 0;
    for (;; ++arena) {
      if (arena == arenas.size()) {
        arenas.emplace_back();
        plan.arena_bytes.push_back(0);
      }
      offset = lowest_free_offset(arenas[arena], request, bytes, alias);
      if (offset + bytes <= max_arena_bytes) break;
    }
    const auto position = std::ranges::lower_bound(arenas[arena], offset, {}, &Placed::begin);
    arenas[arena].insert(position, Placed{offset, offset + bytes, request.first_pass, request.last_pass});
    plan.arena_bytes[arena] = std::max(plan.arena_bytes[arena], offset + bytes);
    plan.offsets[i] = offset;
    plan.arenas[i] = static_cast<int>(arena);
  }
  plan.total_bytes = std::accumulate(plan.arena_bytes.begin(), plan.arena_bytes.end(), std::uint64_t{0});
  return plan;
}

}  // namespace becalm::gpu
