#include "filter/gpu/scratch.h"

#include <algorithm>

namespace becalm::gpu {

void Scratch::reserve(const vk::raii::Device& device, std::uint32_t memory_type, bool is_mapped,
                      std::span<const std::uint64_t> bytes) {
  std::shared_ptr<const Arenas>& present = arenas_[{memory_type, is_mapped}];
  std::vector<std::uint64_t> needed(bytes.begin(), bytes.end());
  if (present) {
    needed.resize(std::max(needed.size(), present->bytes.size()));
    for (std::size_t i = 0; i < present->bytes.size(); ++i)
      needed[i] = std::max(needed[i], present->bytes[i]);
    if (needed == present->bytes) return;
  }
  auto grown = std::make_shared<Arenas>();
  grown->bytes = std::move(needed);
  for (const std::uint64_t arena_bytes : grown->bytes) {
    grown->memory.emplace_back(device, vk::MemoryAllocateInfo(arena_bytes, memory_type));
    grown->mapped.push_back(
        is_mapped ? static_cast<std::byte*>(grown->memory.back().mapMemory(0, VK_WHOLE_SIZE)) : nullptr);
  }
  present = std::move(grown);
}

std::shared_ptr<const Scratch::Arenas> Scratch::arenas(std::uint32_t memory_type, bool is_mapped) const {
  return arenas_.at({memory_type, is_mapped});
}

}  // namespace becalm::gpu
