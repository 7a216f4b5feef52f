// Steps, memory, pipelines and descriptors of a chain whose declarations have been checked.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "filter/gpu/chain_impl.h"
#include "filter/gpu/memory_plan.h"

namespace becalm::gpu {

namespace {

/// Bytes of one part of the buffer that absent bindings are bound to. Absent bindings that are read share one
/// part; each one that is written has a part of its own, or validation would report hazards. The size is the
/// largest alignment that a device may require of a buffer's offset.
constexpr std::uint64_t kNothingBytes = 256;

vk::Format texel_format(Format format) {
  switch (format) {
    case Format::f32:
      return vk::Format::eR32Sfloat;
    case Format::f32x2:
      return vk::Format::eR32G32Sfloat;
    case Format::f32x4:
      return vk::Format::eR32G32B32A32Sfloat;
  }
  return vk::Format::eUndefined;
}

/// llvmpipe (Mesa 22.3) compiles a kernel again for texel buffers whose size in bytes is a power of two or
/// has zeros in bits 8 to 15, which it takes for the sizes and mipmap levels of textures. Such buffers are
/// larger than their images.
std::uint64_t buffer_bytes(std::uint64_t image_bytes) {
  std::uint64_t bytes = image_bytes;
  while (std::has_single_bit(bytes) || (bytes >> 8 & 0xff) == 0) bytes += 256;
  return bytes;
}

vk::BufferCreateInfo buffer_of(const ImageDeclaration& image) {
  using Usage = vk::BufferUsageFlagBits;
  return {{},
          buffer_bytes(image.bytes()),
          Usage::eStorageBuffer | Usage::eUniformTexelBuffer | Usage::eTransferSrc | Usage::eTransferDst};
}

SpecValues spec_values(const PassDeclaration& pass) {
  SpecValues values;
  for (const auto& [name, value] : pass.specializations) {
    const SpecConstantInfo& info =
        *std::ranges::find(pass.kernel->spec_constants, name, &SpecConstantInfo::name);
    values.emplace_back(info.id, value);
  }
  std::ranges::sort(values);
  return values;
}

}  // namespace

void Chain::Impl::plan_steps() {
  std::vector<std::size_t> last_write(images.size());
  for (std::size_t i = 0; i < passes.size(); ++i) {
    for (const Use& use : passes[i].uses) {
      if (use.writes()) last_write[static_cast<std::size_t>(use.image)] = i;
    }
  }
  std::vector<bool> is_uploaded(images.size());
  for (std::size_t i = 0; i < passes.size(); ++i) {
    for (const Use& use : passes[i].uses) {
      const auto image = static_cast<std::size_t>(use.image);
      if (images[image].role != Role::input || is_uploaded[image] || is_in_place()) continue;
      steps.push_back({Step::Kind::upload, use.image});
      is_uploaded[image] = true;
    }
    steps.push_back({Step::Kind::pass, static_cast<int>(i)});
    for (const Use& use : passes[i].uses) {
      const auto image = static_cast<std::size_t>(use.image);
      if (use.writes() && images[image].is_output && last_write[image] == i && !is_in_place()) {
        steps.push_back({Step::Kind::download, use.image});
      }
    }
  }
}

void Chain::Impl::plan_segments() {
  segments.emplace_back();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool is_host = steps[i].kind == Step::Kind::pass &&
                         passes[static_cast<std::size_t>(steps[i].index)].kind == PassKind::host;
    if (!is_host) {
      segments.back().end_step = i + 1;
      continue;
    }
    segments.back().host_pass = steps[i].index;
    segments.push_back({.first_step = i + 1, .end_step = i + 1});
  }
}

std::vector<std::optional<Lifetime>> Chain::Impl::lifetimes() const {
  std::vector<std::optional<Lifetime>> result(images.size());
  const auto touch = [&](int image, int step) {
    std::optional<Lifetime>& lifetime = result[static_cast<std::size_t>(image)];
    if (!lifetime) lifetime = Lifetime{.first = step, .last = step};
    lifetime->last = step;
  };
  for (int step = 0; step < static_cast<int>(steps.size()); ++step) {
    const auto [kind, index] = steps[static_cast<std::size_t>(step)];
    if (kind != Step::Kind::pass) {
      touch(index, step);
      continue;
    }
    for (const Use& use : passes[static_cast<std::size_t>(index)].uses) touch(use.image, step);
  }
  if (!is_in_place() || steps.empty()) return result;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].role == Role::input) result[i] = {.first = 0, .last = result[i] ? result[i]->last : 0};
    if (images[i].is_output) touch(static_cast<int>(i), static_cast<int>(steps.size()) - 1);
  }
  return result;
}

void Chain::Impl::find_replaced_histories(const std::vector<std::optional<Lifetime>>& lived) {
  if (!options.alias_memory) return;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].role != Role::history_next || !lived[i]) continue;
    const std::optional<Lifetime>& previous = lived[static_cast<std::size_t>(images[i].partner)];
    images[i].replaces_previous = !previous || previous->last < lived[i]->first;
  }
}

void Chain::Impl::plan_memory() {
  const std::vector<std::optional<Lifetime>> lived = lifetimes();
  find_replaced_histories(lived);
  buffers.resize(images.size());
  std::uint64_t replaced_bytes = 0;
  std::vector<MemoryRequest> requests;  // of what no run leaves to the next
  std::vector<std::size_t> owners;
  std::vector<std::size_t> kept;
  std::uint32_t types = ~0u;
  std::uint64_t alignment = 1;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const bool is_transferred = images[i].role == Role::input || images[i].is_output;
    if (is_in_place() ? images[i].is_table : is_transferred) staging_bytes += images[i].bytes();
    if (!lived[i] && !is_kept(images[i])) continue;
    const vk::BufferCreateInfo create = buffer_of(images[i]);
    const vk::MemoryRequirements needs =
        device.device.getBufferMemoryRequirements(vk::DeviceBufferMemoryRequirements(&create))
            .memoryRequirements;
    types &= needs.memoryTypeBits;
    alignment = std::max<std::uint64_t>(alignment, needs.alignment);  // powers of two
    buffers[i].bytes = needs.size;
    if (is_kept(images[i])) {
      kept.push_back(i);
      if (!images[i].is_history()) continue;
      (images[i].replaces_previous ? replaced_bytes : bytes.own) += needs.size;
      replaces_history |= images[i].replaces_previous;
      continue;
    }
    requests.push_back({needs.size, lived[i]->first, lived[i]->last});
    owners.push_back(i);
  }

  const auto aligned = [&](std::uint64_t size) { return (size + alignment - 1) / alignment * alignment; };
  for (std::size_t i = 0; i < images.size(); ++i) {
    require_bytes(images[i], aligned(buffers[i].bytes), device.max_allocation_bytes, device.info.name,
                  label() + ": ", "hold in one piece");
  }
  std::uint64_t largest = 0;
  for (const MemoryRequest& request : requests) largest = std::max(largest, request.bytes);
  const std::uint64_t limit =
      std::min(device.max_allocation_bytes, std::max(options.max_arena_bytes, aligned(largest)));
  const MemoryPlan plan = gpu::plan_memory(requests, alignment, options.alias_memory, limit);
  for (std::size_t i = 0; i < owners.size(); ++i) {
    buffers[owners[i]].arena = plan.arenas[i];
    buffers[owners[i]].offset = plan.offsets[i];
  }
  scratch_bytes = plan.arena_bytes;
  for (const std::size_t i : kept) {
    if (images[i].replaces_previous) {
      buffers[i].arena = buffers[static_cast<std::size_t>(images[i].partner)].arena;  // declared before it
      continue;
    }
    buffers[i].arena = static_cast<int>(scratch_bytes.size() + own_bytes.size());
    own_bytes.push_back(buffers[i].bytes);
  }
  using Memory = vk::MemoryPropertyFlagBits;
  // If the device is a processor, host-visible memory is as fast as any other.
  memory_type = is_mapped() ? device.memory_type(types, Memory::eHostVisible | Memory::eHostCoherent,
                                                 Memory::eHostCached | Memory::eDeviceLocal)
                            : device.memory_type(types, {}, Memory::eDeviceLocal);
  bytes.scratch = scratch_bytes;
  device_bytes_unaliased =
      bytes.own + replaced_bytes + gpu::plan_memory(requests, alignment, false, limit).total_bytes;
}

void Chain::Impl::allocate() {
  std::vector<std::byte*> mapped(own_bytes.size());
  guarded(label() + ": " + format_mib(bytes.total()) + " of device memory", [&] {
    reservation = device.scratch.reserve(device.device, memory_type, is_mapped(), scratch_bytes);
    for (std::size_t i = 0; i < own_bytes.size(); ++i) {
      own.emplace_back(device.device, vk::MemoryAllocateInfo(own_bytes[i], memory_type));
      if (is_mapped()) mapped[i] = static_cast<std::byte*>(own[i].mapMemory(0, VK_WHOLE_SIZE));
    }
  });
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (buffers[i].bytes == 0 || is_scratch(buffers[i])) continue;
    const std::size_t arena = static_cast<std::size_t>(buffers[i].arena) - scratch_bytes.size();
    bind_image(i, own[arena], mapped[arena]);
  }
}

void Chain::Impl::bind_image(std::size_t image, const vk::raii::DeviceMemory& memory, std::byte* mapped) {
  DeviceBuffer& buffer = buffers[image];
  buffer.texels = nullptr;
  buffer.buffer = {device.device, buffer_of(images[image])};
  device.set_name(buffer.buffer, images[image].name);
  buffer.buffer.bindMemory(*memory, buffer.offset);
  if (mapped != nullptr) buffer.mapped = mapped + buffer.offset;
  if (images[image].extent.elements() <= device.limits.maxTexelBufferElements) {
    buffer.texels = {
        device.device,
        vk::BufferViewCreateInfo({}, *buffer.buffer, texel_format(images[image].format), 0, VK_WHOLE_SIZE)};
  }
}

void Chain::Impl::bind_scratch() {
  const Scratch::Arenas& present = device.scratch.arenas(device.device, memory_type, is_mapped());
  if (scratch_version == present.version) return;
  for (Segment& segment : segments) segment.commands = {nullptr, nullptr};
  reset_commands = nullptr;
  for (auto& sets : descriptor_sets) sets.clear();
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (buffers[i].bytes == 0 || !is_scratch(buffers[i])) continue;
    const Scratch::Arena& arena = present.list[static_cast<std::size_t>(buffers[i].arena)];
    bind_image(i, arena.memory, arena.mapped);
  }
  create_descriptor_sets();
  record_all();
  scratch_version = present.version;  // last: what threw before is done again by the next run
}

void Chain::Impl::take_scratch() {
  guarded(label(), [&] { bind_scratch(); });
  if (device.scratch.user == this) return;
  device.scratch.user = this;
  forget_inputs();
  holds_outputs = false;
}

void Chain::Impl::forget_inputs() {
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!images[i].is_table) is_filled[i] = false;
  }
}

void Chain::Impl::create_staging() {
  using Usage = vk::BufferUsageFlagBits;
  is_filled.resize(images.size());
  if (is_in_place()) return;
  staging.resize(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const bool is_input = images[i].role == Role::input;
    if (!is_input && !images[i].is_output) continue;
    staging[i] = device.create_host_buffer(
        images[i].bytes(), is_input ? Usage::eTransferSrc : Usage::eTransferDst, images[i].name + " (host)");
  }
}

void Chain::Impl::create_pipelines() {
  pipelines.resize(passes.size());
  std::set<std::pair<const Kernel*, SpecValues>> seen;
  std::vector<std::size_t> first_uses;
  std::vector<std::size_t> other_uses;
  for (std::size_t i = 0; i < passes.size(); ++i) {
    if (passes[i].kind != PassKind::kernel) continue;
    (seen.emplace(passes[i].kernel, spec_values(passes[i])).second ? first_uses : other_uses).push_back(i);
  }
  const auto create = [&](std::size_t i) {
    guarded(label(i), [&] {
      const Kernel& kernel = *passes[i].kernel;
      pipelines[i] = {device.programs->pipeline(kernel, spec_values(passes[i])),
                      *device.programs->layout(kernel).pipeline};
    });
  };
  // A driver compiles a pipeline on the calling thread. The largest kernels come first: one of them can take
  // as long as all others.
  std::ranges::sort(first_uses, std::greater(),
                    [&](std::size_t i) { return passes[i].kernel->spirv.size(); });
  tbb::parallel_for(std::size_t{0}, first_uses.size(), [&](std::size_t k) { create(first_uses[k]); });
  std::ranges::for_each(other_uses, create);
}

void Chain::Impl::create_nothing() {
  std::size_t absent = 0;
  for (const PassDeclaration& pass : passes) {
    if (pass.kind == PassKind::kernel) absent += pass.absent.size() * static_cast<std::size_t>(pass.bands());
  }
  if (absent == 0) return;
  using Usage = vk::BufferUsageFlagBits;
  nothing = device.create_host_buffer((absent + 1) * kNothingBytes,
                                      Usage::eStorageBuffer | Usage::eUniformTexelBuffer, name + " nothing");
  nothing_texels = {device.device, {{}, *nothing.buffer, texel_format(Format::f32x4), 0, kNothingBytes}};
}

void Chain::Impl::create_descriptor_sets() {
  const std::uint32_t parities = has_history ? 2 : 1;
  std::uint32_t storage_buffers = 0;
  std::uint32_t texel_buffers = 0;
  std::vector<vk::DescriptorSetLayout> layouts;
  for (const PassDeclaration& pass : passes) {
    if (pass.kind != PassKind::kernel) continue;
    const int bands = pass.bands();
    layouts.insert(layouts.end(), static_cast<std::size_t>(bands),
                   *device.programs->layout(*pass.kernel).bindings);
    for (const BindingInfo& binding : pass.kernel->bindings) {
      (binding.is_texel_buffer() ? texel_buffers : storage_buffers) += static_cast<std::uint32_t>(bands);
    }
  }
  std::vector<vk::DescriptorPoolSize> sizes{{vk::DescriptorType::eStorageBuffer, storage_buffers * parities}};
  if (texel_buffers > 0) {
    sizes.emplace_back(vk::DescriptorType::eUniformTexelBuffer, texel_buffers * parities);
  }
  const auto set_count = static_cast<std::uint32_t>(layouts.size()) * parities;
  if (set_count == 0) return;
  constexpr auto freed_one_by_one =
      vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet;  // as vulkan_raii does
  descriptor_pool = {device.device, vk::DescriptorPoolCreateInfo(freed_one_by_one, set_count, sizes)};
  for (std::uint32_t p = 0; p < parities; ++p) {
    std::vector<vk::raii::DescriptorSet> sets =
        device.device.allocateDescriptorSets({*descriptor_pool, layouts});
    auto next_set = sets.begin();
    std::uint64_t next_nothing = 1;
    for (const PassDeclaration& pass : passes) {
      auto& of_pass = descriptor_sets[p].emplace_back();
      if (pass.kind != PassKind::kernel) continue;
      const auto binding_of = [&](const std::string& binding) -> const BindingInfo& {
        return *std::ranges::find(pass.kernel->bindings, binding, &BindingInfo::name);
      };
      for (int band = 0; band < pass.bands(); ++band) {
        const vk::DescriptorSet set = *of_pass.emplace_back(std::move(*next_set++));
        for (const Use& use : pass.uses) {
          const DeviceBuffer& memory = buffer(use.image, static_cast<int>(p));
          const BufferPart part = part_of_band(pass, use, images[static_cast<std::size_t>(use.image)], band);
          bind(set, binding_of(use.binding), {*memory.buffer, part.offset, part.bytes}, *memory.texels);
        }
        for (const std::string& absent : pass.absent) {
          const BindingInfo& binding = binding_of(absent);
          const std::uint64_t offset = binding.writes ? kNothingBytes * next_nothing++ : 0;
          bind(set, binding, {*nothing.buffer, offset, kNothingBytes}, *nothing_texels);
        }
      }
    }
  }
}

void Chain::Impl::bind(vk::DescriptorSet set, const BindingInfo& binding,
                       const vk::DescriptorBufferInfo& part, vk::BufferView texels) const {
  vk::WriteDescriptorSet write(set, binding.binding, 0, 1, descriptor_type(binding));
  if (binding.is_texel_buffer()) {
    write.setTexelBufferView(texels);
  } else {
    write.setBufferInfo(part);
  }
  device.device.updateDescriptorSets(write, {});
}

}  // namespace becalm::gpu
