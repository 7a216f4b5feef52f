#pragma once

// For the files of filter/gpu/ alone: what a Device holds. vulkan_raii.hpp makes them slow to compile.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "filter/gpu/device.h"

namespace becalm::gpu {

/// Runs `action`; a Vulkan error becomes a DeviceError whose line starts with `what`.
template <class Action>
decltype(auto) guarded(std::string_view what, Action&& action) {
  try {
    return std::forward<Action>(action)();
  } catch (const vk::SystemError& error) {
    throw DeviceError(std::string(what) + ": " + error.what());
  }
}

/// `1920x1080 float`-style figures in messages: bytes as MiB with one digit.
std::string format_mib(std::uint64_t bytes);

/// A buffer with memory of its own that the host sees; mapped for its whole life.
struct HostBuffer {
  vk::raii::DeviceMemory memory = nullptr;
  vk::raii::Buffer buffer = nullptr;  // after memory, so that it goes first
  std::byte* mapped = nullptr;
  std::uint64_t bytes = 0;
};

class Programs;

struct Device::Impl {
  explicit Impl(const DeviceOptions& options);
  ~Impl();

  HostBuffer create_host_buffer(std::uint64_t bytes, vk::BufferUsageFlags usage,
                                const std::string& name) const;
  /// Index of the first of `types` that has `wanted`, else of the first that has `needed`.
  std::uint32_t memory_type(std::uint32_t types, vk::MemoryPropertyFlags needed,
                            vk::MemoryPropertyFlags wanted) const;
  /// Gives a Vulkan object the name under which tools and validation messages show it.
  template <class Handle>
  void set_name(const Handle& object, const std::string& name) const {
    if (!has_debug_utils) return;
    const auto handle = reinterpret_cast<std::uint64_t>(static_cast<typename Handle::CType>(*object));
    device.setDebugUtilsObjectNameEXT({Handle::objectType, handle, name.c_str()});
  }
  /// Throws if validation has had anything to say since the last call.
  void check_validation(std::string_view what);

  // In this order: each needs those before it.
  vk::raii::Context context;
  std::vector<std::string> messages;
  std::size_t messages_checked = 0;
  bool has_debug_utils = false;
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical_device = nullptr;
  std::uint32_t queue_family = 0;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  std::unique_ptr<Programs> programs;

  DeviceInfo info;
  vk::PhysicalDeviceLimits limits;
  vk::PhysicalDeviceMemoryProperties memory_properties;
  std::uint64_t max_allocation_bytes = 0;
  std::uint64_t max_buffer_bytes = 0;
  std::uint32_t timestamp_bits = 0;  // 0: none
};

}  // namespace becalm::gpu
