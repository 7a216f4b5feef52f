#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace becalm::gpu {

/// One buffer of a kernel, reflected from its SPIR-V at build time.
struct BindingInfo {
  std::string_view name;  ///< the role: the GLSL instance name, such as `offset_coarse`
  std::uint32_t binding;  ///< in descriptor set 0
  /// "float", "vec2" or "vec4" for a storage buffer; "texel" for a texel buffer of any of these.
  std::string_view element;
  bool reads;
  bool writes;

  constexpr bool is_texel_buffer() const { return element == "texel"; }
};

/// A specialization constant, of type int.
struct SpecConstantInfo {
  std::string_view name;
  std::uint32_t id;
};

/// Push constants that the chain supplies: width and height of an image, or of the dispatch.
struct SizeInfo {
  std::string_view binding;  ///< the image's; empty for the dispatch
  std::uint32_t offset;      ///< in the push constants, bytes
};

/// A compiled kernel: its SPIR-V and the interface reflected from it. Embedded in the executable at build
/// time.
struct Kernel {
  std::string_view name;  ///< path below shaders/ without the ending: `align/median_offset`
  std::span<const std::uint32_t> spirv;
  std::span<const BindingInfo> bindings;
  std::span<const SpecConstantInfo> spec_constants;
  std::span<const SizeInfo> sizes;    ///< the first push constants
  std::uint32_t constants_offset;     ///< of those after them, which the pass declares
  std::uint32_t push_constant_bytes;  ///< of all
  /// Of the push constant `first_row`, in bytes, if the kernel has it: the kernel then makes the rows from
  /// that one on, and what it writes is bound from there on.
  std::optional<std::uint32_t> first_row_offset;
  std::uint32_t local_size[3];
};

/// Kernels of the whole project, compiled by shaders/CMakeLists.txt; sorted by name.
std::span<const Kernel> embedded_kernels();

}  // namespace becalm::gpu
