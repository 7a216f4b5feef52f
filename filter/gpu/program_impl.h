#pragma once

// For the files of filter/gpu/ alone: pipelines made from embedded kernels.

#include <cstdint>
#include <map>
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

/// The device's layouts and pipelines. Makes each once, however many passes of however many chains use it,
/// since a pipeline can take a second to compile. References stay valid as long as the device. Kernels are
/// those of embedded tables, which last.
class Programs {
 public:
  explicit Programs(const Device::Impl& device) : device_(device) {}
  const ProgramLayout& layout(const Kernel& kernel);
  vk::Pipeline pipeline(const Kernel& kernel, const SpecValues& values);

 private:
  const Device::Impl& device_;
  std::map<const Kernel*, ProgramLayout> layouts_;
  std::map<std::pair<const Kernel*, SpecValues>, vk::raii::Pipeline> pipelines_;
};

}  // namespace becalm::gpu
