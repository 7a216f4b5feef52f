#pragma once

// For the files of filter/gpu/ alone: timestamps around the passes of a command buffer.

#include <cstdint>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "filter/gpu/device_impl.h"
#include "filter/gpu/profiler.h"

namespace becalm::gpu {

class PassTimer {
 public:
  /// Does nothing, and says 0, where the device's queue has no timestamps.
  PassTimer(const Device::Impl& device, std::uint32_t passes);
  void reset(const vk::raii::CommandBuffer& commands) const;
  void begin(const vk::raii::CommandBuffer& commands, std::uint32_t pass) const { stamp(commands, 2 * pass); }
  void end(const vk::raii::CommandBuffer& commands, std::uint32_t pass) const {
    stamp(commands, 2 * pass + 1);
  }
  /// Of a pass that was recorded, once its commands have ended.
  double milliseconds(std::uint32_t pass) const;

 private:
  void stamp(const vk::raii::CommandBuffer& commands, std::uint32_t query) const;
  std::uint32_t passes_ = 0;
  std::uint64_t valid_bits_ = 0;
  double milliseconds_per_tick_ = 0.0;
  vk::raii::QueryPool pool_ = nullptr;
};

}  // namespace becalm::gpu
