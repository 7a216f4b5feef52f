#include "filter/gpu/program.h"

#include <string>
#include <utility>

#include "filter/gpu/program_impl.h"

namespace becalm::gpu {

const ProgramLayout& Programs::layout(const Kernel& kernel) {
  const std::scoped_lock lock(mutex_);
  if (const auto found = layouts_.find(&kernel); found != layouts_.end()) return found->second;
  ProgramLayout result;
  result.module = {device_.device,
                   vk::ShaderModuleCreateInfo({}, kernel.spirv.size_bytes(), kernel.spirv.data())};
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (const BindingInfo& binding : kernel.bindings) {
    bindings.emplace_back(binding.binding, descriptor_type(binding), 1, vk::ShaderStageFlagBits::eCompute);
  }
  result.bindings = {device_.device, vk::DescriptorSetLayoutCreateInfo({}, bindings)};
  const vk::PushConstantRange constants(vk::ShaderStageFlagBits::eCompute, 0, kernel.push_constant_bytes);
  vk::PipelineLayoutCreateInfo create({}, *result.bindings);
  if (kernel.push_constant_bytes > 0) create.setPushConstantRanges(constants);
  result.pipeline = {device_.device, create};
  return layouts_.emplace(&kernel, std::move(result)).first->second;
}

vk::Pipeline Programs::pipeline(const Kernel& kernel, const SpecValues& values) {
  const auto key = std::pair(&kernel, values);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = pipelines_.find(key); found != pipelines_.end()) return *found->second;
  }
  std::vector<vk::SpecializationMapEntry> entries;
  std::vector<std::int32_t> data;
  std::string label(kernel.name);
  for (const auto& [id, value] : values) {
    entries.emplace_back(id, static_cast<std::uint32_t>(data.size() * sizeof(value)), sizeof(value));
    data.push_back(value);
    label += ' ' + std::to_string(value);
  }
  const vk::SpecializationInfo specialization(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                              data.size() * sizeof(data[0]), data.data());
  const ProgramLayout& shared = layout(kernel);
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *shared.module, "main",
                                                &specialization);
  vk::raii::Pipeline pipeline(device_.device, nullptr,
                              vk::ComputePipelineCreateInfo({}, stage, *shared.pipeline));
  device_.set_name(pipeline, label);
  const std::scoped_lock lock(mutex_);
  return *pipelines_.emplace(key, std::move(pipeline)).first->second;
}

}  // namespace becalm::gpu
