// The checks of Chain::plan, which come before anything is allocated, and the kernels' push constants.

#include <algorithm>
#include <array>

#include "filter/gpu/chain_impl.h"

namespace becalm::gpu {

namespace {

std::string_view element_of(Format format) {
  switch (format) {
    case Format::f32:
      return "float";
    case Format::f32x2:
      return "vec2";
    case Format::f32x4:
      return "vec4";
  }
  return "";
}

std::string to_string(Extent extent) {
  std::string text = std::to_string(extent.width) + "x" + std::to_string(extent.height);
  if (extent.planes != 1) text += "x" + std::to_string(extent.planes);
  return text;
}

std::string_view access_name(bool reads, bool writes) {
  return !writes ? "read" : reads ? "read_write" : "write";
}

const Kernel& find_kernel(std::span<const Kernel> kernels, const PassDeclaration& pass,
                          const std::string& where) {
  const auto found = std::ranges::find(kernels, pass.name, &Kernel::name);
  if (found == kernels.end()) throw DeviceError(where + "there is no such kernel");
  return *found;
}

void check_binding(const Kernel& kernel, const PassDeclaration& pass, const ImageDeclaration& image,
                   const Use& use, const Device::Impl& device, const std::string& where) {
  const auto found = std::ranges::find(kernel.bindings, use.binding, &BindingInfo::name);
  if (found == kernel.bindings.end()) {
    std::string known;
    for (const BindingInfo& binding : kernel.bindings)
      known += (known.empty() ? "" : ", ") + std::string(binding.name);
    throw DeviceError(where + "the kernel has no such binding; it has: " + known);
  }
  const vk::PhysicalDeviceLimits& limits = device.limits;
  if (found->is_texel_buffer()) {
    if (image.extent.elements() > limits.maxTexelBufferElements) {
      throw DeviceLimitError(where + "image '" + image.name + "' has " +
                             std::to_string(image.extent.elements()) +
                             " elements, the device reads at most " +
                             std::to_string(limits.maxTexelBufferElements) + " as texels");
    }
  } else if (found->element != element_of(image.format)) {
    throw DeviceError(where + "the kernel's elements are " + std::string(found->element) +
                      ", those of image '" + image.name + "' " + std::string(element_of(image.format)));
  } else {
    require_bytes(image, part_of_band(pass, use, image, 0).bytes, limits.maxStorageBufferRange,
                  device.info.name, where, "bind");
  }
  if (found->reads != use.reads() || found->writes != use.writes()) {
    throw DeviceError(where + "the kernel's access is " +
                      std::string(access_name(found->reads, found->writes)) + ", the pass declares " +
                      std::string(access_name(use.reads(), use.writes())));
  }
}

/// Each binding of the kernel must be given once. An image that is written, or a plane of it, must have no
/// other binding, which would be a race.
void check_bindings(const Kernel& kernel, const PassDeclaration& pass,
                    std::span<const ImageDeclaration> images, const Device::Impl& device,
                    const std::string& where) {
  for (const Use& use : pass.uses) {
    check_binding(kernel, pass, images[static_cast<std::size_t>(use.image)], use, device,
                  where + "binding '" + use.binding + "': ");
    for (const Use* other = pass.uses.data(); other != &use; ++other) {
      if (other->binding == use.binding)
        throw DeviceError(where + "binding '" + use.binding + "' is given twice");
      const bool other_plane = use.plane && other->plane && *use.plane != *other->plane;
      if (other->image == use.image && (other->writes() || use.writes()) && !other_plane) {
        throw DeviceError(where + "image '" + images[static_cast<std::size_t>(use.image)].name +
                          "' is written as '" + (use.writes() ? use : *other).binding + "' and used as '" +
                          (use.writes() ? *other : use).binding + "' at once");
      }
    }
  }
  for (const std::string& absent : pass.absent) {
    const std::string what = std::string(where).append("binding '").append(absent).append("' ");
    if (std::ranges::find(kernel.bindings, absent, &BindingInfo::name) == kernel.bindings.end()) {
      throw DeviceError(what + "is left without an image, and the kernel has no such binding");
    }
    if (std::ranges::find(pass.uses, absent, &Use::binding) != pass.uses.end()) {
      throw DeviceError(what + "is both given an image and left without one");
    }
  }
  for (const BindingInfo& binding : kernel.bindings) {
    if (std::ranges::find(pass.uses, binding.name, &Use::binding) == pass.uses.end() &&
        std::ranges::find(pass.absent, binding.name) == pass.absent.end()) {
      throw DeviceError(where + "binding '" + std::string(binding.name) + "' has no image");
    }
  }
}

void check_specialization(const Kernel& kernel, const PassDeclaration& pass, const std::string& constant,
                          const std::string& where) {
  const auto known = std::ranges::count(kernel.spec_constants, constant, &SpecConstantInfo::name);
  if (known == 0) throw DeviceError(where + "the kernel has no specialization constant '" + constant + "'");
  const auto given =
      std::ranges::count_if(pass.specializations, [&](const auto& other) { return other.first == constant; });
  if (given > 1) throw DeviceError(where + "specialization constant '" + constant + "' is given twice");
}

void check_constants(const Kernel& kernel, const PassDeclaration& pass, const std::string& where) {
  const std::size_t expected = kernel.push_constant_bytes - kernel.constants_offset;
  if (pass.constants.size() != expected) {
    throw DeviceError(where + "the constants take " + std::to_string(pass.constants.size()) +
                      " bytes, the kernel's take " + std::to_string(expected));
  }
  for (const auto& given : pass.specializations) check_specialization(kernel, pass, given.first, where);
}

/// The sizes that the kernel asks for, 0 x 0 of an image that is left out, then the pass's own constants.
std::vector<std::byte> push_constants(const Kernel& kernel, const PassDeclaration& pass,
                                      std::span<const ImageDeclaration> images) {
  std::vector<std::byte> result(kernel.push_constant_bytes);
  for (const SizeInfo& wanted : kernel.sizes) {
    std::array<std::int32_t, 2> size{};
    if (wanted.binding.empty()) {
      size = {pass.extent->width, pass.extent->height};
    } else if (const auto use = std::ranges::find(pass.uses, wanted.binding, &Use::binding);
               use != pass.uses.end()) {
      const Extent& extent = images[static_cast<std::size_t>(use->image)].extent;
      size = {extent.width, extent.height};
    }
    std::ranges::copy(std::as_bytes(std::span(size)), result.begin() + wanted.offset);
  }
  std::ranges::copy(pass.constants, result.begin() + kernel.constants_offset);
  return result;
}

void check_dispatch(const Kernel& kernel, const PassDeclaration& pass, const vk::PhysicalDeviceLimits& limits,
                    const std::string& where) {
  if (!pass.extent) throw DeviceError(where + "is never dispatched");
  const std::array<int, 3> extent = {pass.extent->width, pass.extent->height, pass.extent->planes};
  std::uint64_t invocations = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (extent[axis] < 1)
      throw DeviceError(where + "the dispatch of " + to_string(*pass.extent) + " is empty");
    const std::uint32_t groups = workgroups(extent[axis], kernel.local_size[axis]);
    if (groups > limits.maxComputeWorkGroupCount[axis]) {
      throw DeviceLimitError(where + "the dispatch of " + to_string(*pass.extent) + " takes " +
                             std::to_string(groups) + " workgroups along axis " + std::to_string(axis) +
                             ", the device's limit is " +
                             std::to_string(limits.maxComputeWorkGroupCount[axis]));
    }
    if (kernel.local_size[axis] > limits.maxComputeWorkGroupSize[axis]) {
      throw DeviceError(where + "a workgroup has " + std::to_string(kernel.local_size[axis]) +
                        " invocations along axis " + std::to_string(axis) + ", the device's limit is " +
                        std::to_string(limits.maxComputeWorkGroupSize[axis]));
    }
    invocations *= kernel.local_size[axis];
  }
  if (invocations > limits.maxComputeWorkGroupInvocations) {
    throw DeviceError(where + "a workgroup has " + std::to_string(invocations) +
                      " invocations, the device's limit is " +
                      std::to_string(limits.maxComputeWorkGroupInvocations));
  }
  const auto texel_buffers =
      static_cast<std::size_t>(std::ranges::count_if(kernel.bindings, &BindingInfo::is_texel_buffer));
  const auto check_count = [&](std::size_t count, std::uint32_t limit, const char* what) {
    if (count > limit) {
      throw DeviceError(where + "the kernel has " + std::to_string(count) + what +
                        ", the device's limit is " + std::to_string(limit));
    }
  };
  check_count(kernel.bindings.size() - texel_buffers, limits.maxPerStageDescriptorStorageBuffers,
              " storage buffers");
  check_count(texel_buffers, limits.maxPerStageDescriptorSampledImages, " texel buffers");
}

/// The plane of an image that a pass writes, after `written` others.
void check_plane(const ImageDeclaration& image, const Use& use, int written,
                 const vk::PhysicalDeviceLimits& limits, const std::string& where) {
  const std::string what = where + "binding '" + use.binding + "': plane " + std::to_string(*use.plane) +
                           " of image '" + image.name + "' of " + to_string(image.extent) + " ";
  if (*use.plane < 0 || *use.plane >= image.extent.planes) throw DeviceError(what + "does not exist");
  if (*use.plane > written) {
    throw DeviceError(what + "is written after " + std::to_string(written) + " planes");
  }
  if (image.plane_bytes() % limits.minStorageBufferOffsetAlignment != 0) {
    throw DeviceError(what + "begins where the device cannot bind it");
  }
}

void check_host_pass(const PassDeclaration& pass, std::span<const ImageDeclaration> images,
                     const DeviceInfo& device, const std::string& where) {
  if (!device.is_processor) {
    throw DeviceError(where + "is a host pass, and device '" + device.name + "' is no processor");
  }
  if (!pass.work) throw DeviceError(where + "is never given its work");
  for (const Use& use : pass.uses) {
    for (const Use* other = pass.uses.data(); other != &use; ++other) {
      if (other->image != use.image || (!other->writes() && !use.writes())) continue;
      throw DeviceError(where + "image '" + images[static_cast<std::size_t>(use.image)].name +
                        "' is written and used at once");
    }
  }
}

}  // namespace

void require_bytes(const ImageDeclaration& image, std::uint64_t bytes, std::uint64_t limit,
                   const std::string& device_name, const std::string& where, const char* verb) {
  if (bytes <= limit) return;
  throw DeviceLimitError(where + "image '" + image.name + "' of " + to_string(image.extent) + " " +
                         std::string(element_of(image.format)) + " takes " + format_mib(bytes) +
                         ", more than the " + format_mib(limit) + " that device '" + device_name + "' can " +
                         verb);
}

void Chain::Impl::check() {
  if (passes.empty()) throw DeviceError(label() + ": has no passes");
  for (const ImageDeclaration& image : images) {
    const std::uint64_t limit = std::min(device.max_buffer_bytes, device.max_allocation_bytes);
    require_bytes(image, image.bytes(), limit, device.info.name, label() + ": ", "hold in one piece");
  }

  std::vector<bool> has_content(images.size());
  std::vector<bool> is_written(images.size());
  std::vector<int> written_planes(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    has_content[i] = images[i].role == Role::input || images[i].role == Role::history_previous;
  }
  for (std::size_t i = 0; i < passes.size(); ++i) {
    PassDeclaration& pass = passes[i];
    const std::string where = label(i) + ": ";
    for (const Use& use : pass.uses) static_cast<void>(image({use.image}));
    if (pass.kind == PassKind::host) check_host_pass(pass, images, device.info, where);
    if (pass.kind == PassKind::kernel) {
      pass.kernel = &find_kernel(options.kernels, pass, where);
      check_dispatch(*pass.kernel, pass, device.limits, where);
      pass.band_rows = rows_of_band(pass, images, device.limits.maxStorageBufferRange, where);
      check_bindings(*pass.kernel, pass, images, device, where);
      check_constants(*pass.kernel, pass, where);
      pass.push_constants = push_constants(*pass.kernel, pass, images);
    }
    for (const Use& use : pass.uses) {
      const auto index = static_cast<std::size_t>(use.image);
      const std::string binding = pass.kind != PassKind::kernel ? "" : "binding '" + use.binding + "': ";
      const std::string what = where + binding + "image '" + images[index].name + "' ";
      if (use.reads() && !has_content[index]) throw DeviceError(what + "is read before any pass writes it");
      if (use.writes() && images[index].role == Role::input)
        throw DeviceError(what + "is an input and cannot be written");
      if (use.writes() && images[index].role == Role::history_previous) {
        throw DeviceError(what + "is the previous frame's and cannot be written");
      }
    }
    for (const Use& use : pass.uses) {
      if (!use.writes()) continue;
      const auto index = static_cast<std::size_t>(use.image);
      if (use.plane) {
        check_plane(images[index], use, written_planes[index], device.limits, where);
        written_planes[index] = std::max(written_planes[index], *use.plane + 1);
      } else {
        written_planes[index] = images[index].extent.planes;
      }
      if (written_planes[index] < images[index].extent.planes) continue;
      has_content[index] = true;
      is_written[index] = true;
    }
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (is_written[i]) continue;
    const std::string where = label() + ": image '" + images[i].name + "' ";
    if (images[i].is_output) throw DeviceError(where + "is an output, but no pass writes it");
    if (images[i].role == Role::history_next)
      throw DeviceError(where + "is a history's, but no pass writes it");
  }
}

}  // namespace becalm::gpu
