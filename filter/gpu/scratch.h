#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

namespace becalm::gpu {

/// Device memory that the chains of a device use in turn, for images that no run leaves to the next.
class Scratch {
 public:
  struct Arenas {
    std::vector<std::uint64_t> bytes;
    std::vector<vk::raii::DeviceMemory> memory;
    std::vector<std::byte*> mapped;  ///< null where it is not mapped
  };

  /// From now on `arenas` has at least these sizes, mapped if asked. If that takes new memory, the old is
  /// freed when the last chain that uses it lets go.
  void reserve(const vk::raii::Device& device, std::uint32_t memory_type, bool is_mapped,
               std::span<const std::uint64_t> bytes);
  /// Those of the memory type; the same object until they grow.
  std::shared_ptr<const Arenas> arenas(std::uint32_t memory_type, bool is_mapped) const;

 private:
  std::map<std::pair<std::uint32_t, bool>, std::shared_ptr<const Arenas>> arenas_;
};

}  // namespace becalm::gpu
