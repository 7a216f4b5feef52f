// Records the commands of a chain: its steps, with barriers where there are hazards.

#include <algorithm>
#include <set>

#include "filter/gpu/chain_impl.h"

namespace becalm::gpu {

namespace {

using Stage = vk::PipelineStageFlagBits2;
using Flag = vk::AccessFlagBits2;

constexpr vk::PipelineStageFlags2 kWorkStages = Stage::eComputeShader | Stage::eCopy | Stage::eClear;
constexpr vk::AccessFlags2 kWorkAccesses = Flag::eShaderStorageRead | Flag::eShaderStorageWrite |
                                           Flag::eShaderSampledRead | Flag::eTransferRead |
                                           Flag::eTransferWrite;

void barrier(const vk::raii::CommandBuffer& commands, vk::PipelineStageFlags2 from_stages,
             vk::AccessFlags2 from, vk::PipelineStageFlags2 to_stages, vk::AccessFlags2 to) {
  const vk::MemoryBarrier2 memory(from_stages, from, to_stages, to);
  commands.pipelineBarrier2(vk::DependencyInfo({}, memory));
}

std::string time_name(const PassDeclaration& pass, const std::vector<ImageDeclaration>& images) {
  const auto written = std::ranges::find_if(pass.uses, [](const Use& use) { return use.writes(); });
  if (written == pass.uses.end()) return pass.name;
  return pass.name + " " + images[static_cast<std::size_t>(written->image)].name;
}

std::uint64_t image_bytes(const PassDeclaration& pass, const std::vector<ImageDeclaration>& images) {
  std::set<int> bound;
  std::uint64_t bytes = 0;
  for (const Use& use : pass.uses) {
    if (use.plane) {
      bytes += images[static_cast<std::size_t>(use.image)].plane_bytes();
    } else {
      bound.insert(use.image);
    }
  }
  for (const int image : bound) bytes += images[static_cast<std::size_t>(image)].bytes();
  return bytes;
}

}  // namespace

std::vector<MemoryAccess> Chain::Impl::accesses(const Step& step, int parity) const {
  const auto access = [&](int image, bool writes) {
    const DeviceBuffer& b = buffer(image, parity);
    return MemoryAccess{b.arena, b.offset, b.offset + b.bytes, writes};
  };
  if (step.kind != Step::Kind::pass) return {access(step.index, step.kind == Step::Kind::upload)};
  std::vector<MemoryAccess> result;
  for (const Use& use : passes[static_cast<std::size_t>(step.index)].uses) {
    result.push_back(access(use.image, use.writes()));
  }
  return result;
}

void Chain::Impl::record_pass(const vk::raii::CommandBuffer& commands, std::size_t pass, int parity) const {
  constexpr auto compute = vk::PipelineBindPoint::eCompute;
  const PassDeclaration& declared = passes[pass];
  const auto index = static_cast<std::uint32_t>(pass);
  if (declared.kind == PassKind::fill) {
    timer->begin(commands, index);
    commands.fillBuffer(*buffer(declared.uses.front().image, parity).buffer, 0, VK_WHOLE_SIZE,
                        declared.fill_bits);
    timer->end(commands, index);
    return;
  }
  const auto& [pipeline, layout] = pipelines[pass];
  commands.bindPipeline(compute, pipeline);
  const std::uint32_t* size = declared.kernel->local_size;
  const Extent extent = *declared.extent;
  const auto& sets = descriptor_sets[static_cast<std::size_t>(parity)][pass];
  timer->begin(commands, index);
  for (int band = 0; band < declared.bands(); ++band) {
    commands.bindDescriptorSets(compute, layout, 0, *sets[static_cast<std::size_t>(band)], {});
    if (!declared.push_constants.empty()) {
      commands.pushConstants<std::byte>(layout, vk::ShaderStageFlagBits::eCompute, 0,
                                        push_constants_of_band(declared, band));
    }
    commands.dispatch(workgroups(extent.width, size[0]), workgroups(declared.rows(band), size[1]),
                      workgroups(extent.planes, size[2]));
  }
  timer->end(commands, index);
}

void Chain::Impl::record(const Segment& segment, int parity) const {
  const vk::raii::CommandBuffer& commands = segment.commands[static_cast<std::size_t>(parity)];
  commands.begin(vk::CommandBufferBeginInfo());
  if (segment.first_step == 0) timer->reset(commands);
  // The writes of the previous run or segment must be visible, and its reads of shared memory complete. (A
  // host pass's writes are visible to everything that is submitted after it.)
  barrier(commands, Stage::eAllCommands, Flag::eMemoryWrite, kWorkStages, kWorkAccesses);
  HazardTracker hazards;
  for (std::size_t i = segment.first_step; i < segment.end_step; ++i) {
    const Step& step = steps[i];
    if (hazards.step(accesses(step, parity))) {
      barrier(commands, kWorkStages, kWorkAccesses, kWorkStages, kWorkAccesses);
    }
    const auto index = static_cast<std::size_t>(step.index);
    if (step.kind == Step::Kind::pass) {
      if (device.has_debug_utils) {
        commands.beginDebugUtilsLabelEXT(vk::DebugUtilsLabelEXT(times[index].name.c_str()));
      }
      record_pass(commands, index, parity);
      if (device.has_debug_utils) commands.endDebugUtilsLabelEXT();
      continue;
    }
    const vk::Buffer host = *staging[index].buffer;
    const vk::Buffer image = *buffer(step.index, parity).buffer;
    const bool is_upload = step.kind == Step::Kind::upload;
    const vk::BufferCopy whole(0, 0, images[index].bytes());
    commands.copyBuffer(is_upload ? host : image, is_upload ? image : host, whole);
  }
  if (segment.host_pass >= 0) {
    barrier(commands, kWorkStages, kWorkAccesses, Stage::eHost, Flag::eHostRead | Flag::eHostWrite);
  } else {
    barrier(commands, kWorkStages, kWorkAccesses, Stage::eHost, Flag::eHostRead);
  }
  commands.end();
}

void Chain::Impl::record_reset(const vk::raii::CommandBuffer& commands) const {
  commands.begin(vk::CommandBufferBeginInfo());
  barrier(commands, Stage::eAllCommands, Flag::eMemoryWrite, Stage::eClear, Flag::eTransferWrite);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].is_history() && !images[i].replaces_previous)
      commands.fillBuffer(*buffers[i].buffer, 0, VK_WHOLE_SIZE, 0);
  }
  commands.end();
}

void Chain::Impl::declare_times() {
  for (const PassDeclaration& pass : passes) {
    times.push_back({.name = time_name(pass, images), .image_bytes = image_bytes(pass, images)});
  }
}

void Chain::Impl::record_all() {
  timer.emplace(device, static_cast<std::uint32_t>(passes.size()));
  command_pool = {device.device, vk::CommandPoolCreateInfo({}, device.queue_family)};
  const std::uint32_t parities = has_history ? 2 : 1;
  const auto count = static_cast<std::uint32_t>(segments.size()) * parities + 1;
  auto allocated =
      device.device.allocateCommandBuffers({*command_pool, vk::CommandBufferLevel::ePrimary, count});
  auto next = allocated.begin();
  for (Segment& segment : segments) {
    for (std::uint32_t p = 0; p < parities; ++p) {
      segment.commands[p] = std::move(*next++);
      record(segment, static_cast<int>(p));
    }
  }
  reset_commands = std::move(*next);
  record_reset(reset_commands);
  fence = {device.device, vk::FenceCreateInfo()};
}

}  // namespace becalm::gpu
