#pragma once

// Private to filter/gpu/: timestamps around the passes of a command buffer.

#include <cstdint>

#include <vulkan/vulkan_raii.hpp>

#include "filter/gpu/device_impl.h"
#include "filter/gpu/profiler.h"

namespace becalm::gpu {

class PassTimer {
 public:
  /// If the device's queue has no timestamps, all functions do nothing and times are 0.
  PassTimer(const Device::Impl& device, std::uint32_t passes);
  void reset(const vk::raii::CommandBuffer& commands) const;
  void begin(const vk::raii::CommandBuffer& commands, std::uint32_t pass) const { stamp(commands, 2 * pass); }
  void end(const vk::raii::CommandBuffer& commands, std::uint32_t pass) const {
    stamp(commands, 2 * pass + 1);
  }
  /// Time of a recorded pass; call it after its commands have ended.
  double milliseconds(std::uint32_t pass) const;

 private:
  void stamp(const vk::raii::CommandBuffer& commands, std::uint32_t query) const;
  std::uint32_t passes_ = 0;
  std::uint64_t valid_bits_ = 0;
  double milliseconds_per_tick_ = 0.0;
  vk::raii::QueryPool pool_ = nullptr;
};

}  // namespace becalm::gpu
