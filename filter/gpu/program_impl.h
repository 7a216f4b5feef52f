#pragma once

// Private to filter/gpu/: pipelines made from embedded kernels.

#include <cstdint>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "filter/gpu/device_impl.h"
#include "filter/gpu/program.h"

namespace becalm::gpu {

/// Constant ids and their values, sorted by id.
using SpecValues = std::vector<std::pair<std::uint32_t, std::int32_t>>;

constexpr vk::DescriptorType descriptor_type(const BindingInfo& binding) {
  return binding.is_texel_buffer() ? vk::DescriptorType::eUniformTexelBuffer
                                   : vk::DescriptorType::eStorageBuffer;
}

/// Objects that all pipelines of one kernel share.
struct ProgramLayout {
  vk::raii::ShaderModule module = nullptr;
  vk::raii::DescriptorSetLayout bindings = nullptr;
  vk::raii::PipelineLayout pipeline = nullptr;
};

/// The device's layouts and pipelines. Each is created once and shared by all passes of all chains, since a
/// pipeline can take a second to compile. Several threads may call it. References stay valid as long as the
/// device. Kernels must come from embedded tables, which are never freed.
class Programs {
 public:
  explicit Programs(const Device::Impl& device) : device_(device) {}
  const ProgramLayout& layout(const Kernel& kernel);
  vk::Pipeline pipeline(const Kernel& kernel, const SpecValues& values);

 private:
  const Device::Impl& device_;
  std::mutex mutex_;  // of the maps; not held while a pipeline is compiled
  std::map<const Kernel*, ProgramLayout> layouts_;
  std::map<std::pair<const Kernel*, SpecValues>, vk::raii::Pipeline> pipelines_;
};

}  // namespace becalm::gpu
