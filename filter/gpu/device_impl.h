#pragma once

// Private to filter/gpu/: the members of a Device. vulkan_raii.hpp is slow to compile.

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "filter/gpu/device.h"
#include "filter/gpu/scratch.h"

namespace becalm::gpu {

/// Runs `action`; a Vulkan error becomes a DeviceError, or DeviceMemoryError, whose line starts with `what`.
template <class Action>
decltype(auto) guarded(std::string_view what, Action&& action) {
  const auto memory_error = [&](const char* whose) {
    return DeviceMemoryError(std::string(what) + ": " + whose +
                             " memory is used up; other programs may hold it");
  };
  try {
    return std::forward<Action>(action)();
  } catch (const vk::OutOfDeviceMemoryError&) {
    throw memory_error("the device's");
  } catch (const vk::OutOfHostMemoryError&) {
    throw memory_error("the host's");
  } catch (const vk::SystemError& error) {
    throw DeviceError(std::string(what) + ": " + error.what());
  }
}

/// What validation said. Threads that create objects side by side add to it.
struct ValidationMessages {
  std::mutex mutex;
  std::vector<std::string> lines;
};

/// Bytes as MiB with one decimal, for messages.
std::string format_mib(std::uint64_t bytes);

/// A buffer with its own host-visible memory, mapped for its whole lifetime.
struct HostBuffer {
  vk::raii::DeviceMemory memory = nullptr;
  vk::raii::Buffer buffer = nullptr;  // declared after memory, so that it is destroyed first
  std::byte* mapped = nullptr;
  std::uint64_t bytes = 0;
};

class Programs;

struct Device::Impl {
  explicit Impl(const DeviceOptions& options);
  ~Impl();

  HostBuffer create_host_buffer(std::uint64_t bytes, vk::BufferUsageFlags usage,
                                const std::string& name) const;
  /// Index of the first of `types` that has `needed` and `wanted`, else of the first that has `needed`.
  std::uint32_t memory_type(std::uint32_t types, vk::MemoryPropertyFlags needed,
                            vk::MemoryPropertyFlags wanted) const;
  /// Sets the name of a Vulkan object in tools and validation messages.
  template <class Handle>
  void set_name(const Handle& object, const std::string& name) const {
    if (!has_debug_utils) return;
    const auto handle = reinterpret_cast<std::uint64_t>(static_cast<typename Handle::CType>(*object));
    device.setDebugUtilsObjectNameEXT({Handle::objectType, handle, name.c_str()});
  }
  /// Throws DeviceError if there are validation messages since the last call.
  void check_validation(std::string_view what);

  // The order matters: each member needs those before it.
  vk::raii::Context context;
  ValidationMessages messages;
  std::size_t messages_checked = 0;
  bool has_debug_utils = false;
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical_device = nullptr;
  std::uint32_t queue_family = 0;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  std::unique_ptr<Programs> programs;
  Scratch scratch;

  DeviceInfo info;
  vk::PhysicalDeviceLimits limits;
  vk::PhysicalDeviceMemoryProperties memory_properties;
  std::uint64_t max_allocation_bytes = 0;
  std::uint64_t max_buffer_bytes = 0;
  std::uint32_t timestamp_bits = 0;  // 0: no timestamps
};

}  // namespace becalm::gpu
