#pragma once

// For the files of filter/gpu/ alone: pipelines made from embedded kernels.

#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "filter/gpu/device_impl.h"
#include "filter/gpu/program.h"

namespace becalm::gpu {

/// Constant id and its 32 bits, in order of id.
using SpecValues = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

constexpr vk::DescriptorType descriptor_type(const BindingInfo& binding) {
  return binding.is_texel_buffer() ? vk::DescriptorType::eUniformTexelBuffer
                                   : vk::DescriptorType::eStorageBuffer;
}

/// What all pipelines of one kernel share.
struct ProgramLayout {
  vk::raii::ShaderModule module = nullptr;
  vk::raii::DescriptorSetLayout bindings = nullptr;
  vk::raii::PipelineLayout pipeline = nullptr;
};

/// Makes every layout and every pipeline once, however many passes use it. References stay valid.
class Programs {
 public:
  explicit Programs(const Device::Impl& device) : device_(device) {}
  const ProgramLayout& layout(const Kernel& kernel);
  vk::Pipeline pipeline(const Kernel& kernel, const SpecValues& values);

 private:
  const Device::Impl& device_;
  std::map<std::string_view, ProgramLayout> layouts_;
  std::map<std::pair<std::string_view, SpecValues>, vk::raii::Pipeline> pipelines_;
};

}  // namespace becalm::gpu
