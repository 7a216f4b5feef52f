#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

namespace becalm::gpu {

/// Device memory that the chains of a device use in turn, for images that no run leaves to the next. Each
/// arena is as large as the reservations that live need it.
class Scratch {
 public:
  using Sizes = std::vector<std::uint64_t>;  ///< of the arenas
  struct Arena {
    std::uint64_t bytes = 0;
    vk::raii::DeviceMemory memory = nullptr;
    std::byte* mapped = nullptr;  ///< null where it is not mapped
  };
  struct Arenas {
    std::vector<Arena> list;
    std::uint64_t version = 1;  ///< grows when any memory changes
  };

  /// Reserves arenas of at least these sizes, mapped if asked, as long as the result lives. Memory of another
  /// size is freed before new memory is allocated, so that no more is held than planned. Throws
  /// vk::SystemError; the next call of either function then tries again.
  std::shared_ptr<const Sizes> reserve(const vk::raii::Device& device, std::uint32_t memory_type,
                                       bool is_mapped, Sizes bytes);
  /// Those of the memory type, for what is reserved now.
  const Arenas& arenas(const vk::raii::Device& device, std::uint32_t memory_type, bool is_mapped);

  /// Whose inputs and outputs the memory holds, by address: the chain that was last uploaded to or run; null
  /// once any memory has changed.
  const void* user = nullptr;

 private:
  struct Pool {
    std::vector<std::weak_ptr<const Sizes>> reservations;
    Arenas arenas;
  };
  std::map<std::pair<std::uint32_t, bool>, Pool> pools_;
};

}  // namespace becalm::gpu
