// embed_spirv OUT.cpp FUNCTION [NAME FILE.spv]...
// Reads compiled kernels and writes one C++ file that defines becalm::gpu::FUNCTION(): their words and what
// reflection says of them, as filter/gpu/program.h declares. A kernel that breaks a convention of
// shaders/README.md stops the build.
#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <optional>
#include <spirv_cross.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

using spirv_cross::Compiler;
using spirv_cross::SPIRType;

struct Binding {
  std::string name;
  std::uint32_t binding = 0;
  std::string element;
  bool reads = false;
  bool writes = false;
};

struct SpecConstant {
  std::string name;
  std::uint32_t id = 0;
};

/// Width and height that the chain supplies.
struct Size {
  std::string binding;  // empty: of the dispatch
  std::uint32_t offset = 0;
};

struct PushConstants {
  std::vector<Size> sizes;
  std::optional<std::uint32_t> first_row_offset;
  std::uint32_t constants_offset = 0;  // of what comes after those
  std::uint32_t bytes = 0;
};

struct Kernel {
  std::string name;
  std::vector<std::uint32_t> words;
  std::vector<Binding> bindings;
  std::vector<SpecConstant> spec_constants;
  PushConstants push_constants;
  std::uint32_t local_size[3] = {1, 1, 1};
};

/// Vulkan guarantees this many bytes on every device.
constexpr std::uint32_t kMaxPushConstantBytes = 128;

void require(bool condition, const std::string& message) {
  if (!condition) throw std::runtime_error(message);
}

std::vector<std::uint32_t> read_words(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream stream;
  stream << file.rdbuf();
  const std::string bytes = stream.str();
  require(file.good() && !bytes.empty() && bytes.size() % 4 == 0, path + " is no SPIR-V file");
  std::vector<std::uint32_t> words(bytes.size() / 4);
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(words.data()));
  return words;
}

void require_binding(const Compiler& compiler, const spirv_cross::Resource& resource,
                     const std::string& where) {
  require(compiler.get_decoration(resource.id, spv::DecorationDescriptorSet) == 0,
          where + "must be in set 0");
  require(compiler.has_decoration(resource.id, spv::DecorationBinding), where + "needs layout(binding = N)");
}

/// GLSL's name of a type that a storage buffer may hold, or an empty string.
std::string element_name(const SPIRType& type) {
  const bool plain = type.width == 32 && type.columns == 1;
  if (plain && type.basetype == SPIRType::Float && type.vecsize == 1) return "float";
  if (plain && type.basetype == SPIRType::Float && type.vecsize == 2) return "vec2";
  if (plain && type.basetype == SPIRType::Float && type.vecsize == 4) return "vec4";
  return "";
}

Binding reflect_binding(const Compiler& compiler, const spirv_cross::Resource& resource) {
  Binding result;
  result.name = compiler.get_name(resource.id);
  require(!result.name.empty(),
          "buffer block '" + resource.name + "' needs an instance name, which names its role");
  const std::string where = "buffer '" + result.name + "': ";
  require_binding(compiler, resource, where);
  result.binding = compiler.get_decoration(resource.id, spv::DecorationBinding);

  const SPIRType& variable = compiler.get_type(resource.type_id);
  const SPIRType& block = compiler.get_type(resource.base_type_id);
  require(variable.array.empty(), where + "arrays of buffers are not supported");
  require(block.member_types.size() == 1, where + "must hold one array `data[]` and nothing else");
  const SPIRType& member = compiler.get_type(block.member_types[0]);
  require(member.array.size() == 1 && member.array[0] == 0,
          where + "must hold one array `data[]` without a size");
  result.element = element_name(member);
  require(!result.element.empty(), where + "elements must be float, vec2 or vec4");

  const spirv_cross::Bitset flags = compiler.get_buffer_block_flags(resource.id);
  result.reads = !flags.get(spv::DecorationNonReadable);
  result.writes = !flags.get(spv::DecorationNonWritable);
  require(result.reads || result.writes, where + "is neither read nor written");
  return result;
}

/// Structs of 4-byte scalars have one layout in C++ and in std430; those of vectors and matrices do not.
void require_scalars(const Compiler& compiler, const SPIRType& type, const std::string& name) {
  if (type.basetype != SPIRType::Struct) {
    require(type.vecsize == 1 && type.columns == 1 && type.width == 32,
            "push constant '" + name + "' must be a 4-byte scalar");
    return;
  }
  for (std::uint32_t i = 0; i < type.member_types.size(); ++i) {
    require_scalars(compiler, compiler.get_type(type.member_types[i]),
                    name + "." + compiler.get_member_name(type.self, i));
  }
}

/// The binding that an ivec2 among the push constants names: `size` or `NAME_size`.
std::string binding_of_size(const std::string& member, const std::vector<Binding>& bindings) {
  if (member == "size") return {};
  constexpr std::string_view ending = "_size";
  if (member.ends_with(ending)) {
    std::string name = member.substr(0, member.size() - ending.size());
    if (std::ranges::find(bindings, name, &Binding::name) != bindings.end()) return name;
  }
  throw std::runtime_error("push constant '" + member + "' must be `size` or `NAME_size` of a buffer NAME");
}

/// `uniform samplerBuffer name`: read as texels of any float format.
Binding reflect_texel_buffer(const Compiler& compiler, const spirv_cross::Resource& resource) {
  Binding result;
  result.name = compiler.get_name(resource.id);
  const std::string where = "texel buffer '" + result.name + "': ";
  const SPIRType& type = compiler.get_type(resource.type_id);
  const SPIRType::BaseType kind = compiler.get_type(type.image.type).basetype;
  require(type.image.dim == spv::DimBuffer && type.array.empty() && kind == SPIRType::Float,
          where + "of images and samplers only samplerBuffer is supported");
  require_binding(compiler, resource, where);
  result.binding = compiler.get_decoration(resource.id, spv::DecorationBinding);
  result.element = "texel";
  result.reads = true;
  return result;
}

PushConstants reflect_push_constants(const Compiler& compiler, const spirv_cross::ShaderResources& resources,
                                     const std::vector<Binding>& bindings) {
  PushConstants result;
  if (resources.push_constant_buffers.empty()) return result;
  const SPIRType& type = compiler.get_type(resources.push_constant_buffers[0].base_type_id);
  result.bytes = static_cast<std::uint32_t>(compiler.get_declared_struct_size(type));
  require(result.bytes <= kMaxPushConstantBytes, "push constants take " + std::to_string(result.bytes) +
                                                     " bytes, more than the 128 that every device has");
  result.constants_offset = result.bytes;
  for (std::uint32_t i = 0; i < type.member_types.size(); ++i) {
    const SPIRType& member = compiler.get_type(type.member_types[i]);
    const std::string& name = compiler.get_member_name(type.self, i);
    const std::uint32_t offset = compiler.type_struct_member_offset(type, i);
    const bool is_first_row = name == "first_row";
    const auto require_first = [&](const std::string& others) {
      if (result.constants_offset == result.bytes) return;
      throw std::runtime_error("push constant '" + name + "' must come before those that " + others);
    };
    if (member.basetype == SPIRType::Int && member.vecsize == 2 && member.columns == 1) {
      require_first("are no sizes");
      result.sizes.push_back({binding_of_size(name, bindings), offset});
    } else if (is_first_row) {
      require(member.basetype == SPIRType::Int && member.vecsize == 1,
              "push constant 'first_row' must be int");
      require_first("passes declare");
      result.first_row_offset = offset;
    } else {
      require_scalars(compiler, member, name);
      result.constants_offset = std::min(result.constants_offset, offset);
    }
  }
  return result;
}

SpecConstant reflect_spec_constant(const Compiler& compiler,
                                   const spirv_cross::SpecializationConstant& constant) {
  SpecConstant result;
  result.name = compiler.get_name(constant.id);
  result.id = constant.constant_id;
  require(!result.name.empty(), "specialization constant " + std::to_string(result.id) + " needs a name");
  const SPIRType& type = compiler.get_type(compiler.get_constant(constant.id).constant_type);
  require(type.basetype == SPIRType::Int && type.width == 32,
          "specialization constant '" + result.name + "' must be int");
  return result;
}

Kernel reflect(const std::string& name, const std::string& path) {
  Kernel kernel;
  kernel.name = name;
  kernel.words = read_words(path);
  const Compiler compiler(kernel.words);

  for (const spv::Capability capability : compiler.get_declared_capabilities()) {
    require(capability == spv::CapabilityShader || capability == spv::CapabilityGroupNonUniform ||
                capability == spv::CapabilitySampledBuffer,
            "needs SPIR-V capability " + std::to_string(capability) +
                ", which filter/gpu/device.cpp does not enable");
  }
  spirv_cross::SpecializationConstant size_constants[3];
  compiler.get_work_group_size_specialization_constants(size_constants[0], size_constants[1],
                                                        size_constants[2]);
  for (int axis = 0; axis < 3; ++axis) {
    require(size_constants[axis].id == spirv_cross::ID(0), "local_size must be a literal, not a constant_id");
    kernel.local_size[axis] = compiler.get_execution_mode_argument(spv::ExecutionModeLocalSize, axis);
  }

  const spirv_cross::ShaderResources resources = compiler.get_shader_resources();
  require(
      resources.storage_images.empty() && resources.separate_samplers.empty() &&
          resources.uniform_buffers.empty() && resources.atomic_counters.empty(),
      "images, samplers and uniform buffers are not supported: use storage buffers, texel buffers and push "
      "constants");
  for (const auto& resource : resources.storage_buffers)
    kernel.bindings.push_back(reflect_binding(compiler, resource));
  for (const auto* textures : {&resources.sampled_images, &resources.separate_images}) {
    for (const auto& resource : *textures)
      kernel.bindings.push_back(reflect_texel_buffer(compiler, resource));
  }
  require(!kernel.bindings.empty(), "has no storage buffer");
  std::ranges::sort(kernel.bindings, {}, &Binding::binding);
  for (std::size_t i = 0; i < kernel.bindings.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::string both =
          "buffers '" + kernel.bindings[j].name + "' and '" + kernel.bindings[i].name + "' ";
      require(kernel.bindings[i].binding != kernel.bindings[j].binding, both + "share one binding number");
      require(kernel.bindings[i].name != kernel.bindings[j].name, both + "share one name");
    }
  }

  kernel.push_constants = reflect_push_constants(compiler, resources, kernel.bindings);
  if (kernel.push_constants.first_row_offset) {
    require(kernel.local_size[1] == 1,
            "next to first_row local_size_y must be 1, so that bands have no partial workgroups");
    for (const Binding& binding : kernel.bindings) {
      require(binding.writes || binding.element == "texel",
              "buffer '" + binding.name + "': next to first_row what is only read must be a texel buffer");
    }
  }
  for (const auto& constant : compiler.get_specialization_constants()) {
    kernel.spec_constants.push_back(reflect_spec_constant(compiler, constant));
  }
  std::ranges::sort(kernel.spec_constants, {}, &SpecConstant::id);
  return kernel;
}

void write_kernel(std::ostream& out, const Kernel& kernel, std::size_t index) {
  out << "// " << kernel.name << "\nconstexpr std::uint32_t kWords" << index << "[] = {" << std::hex;
  for (std::size_t i = 0; i < kernel.words.size(); ++i) {
    out << (i % 12 == 0 ? "\n  " : " ") << "0x" << kernel.words[i] << ',';
  }
  out << std::dec << std::boolalpha << "\n};\n";
  out << "constexpr BindingInfo kBindings" << index << "[] = {\n";
  for (const Binding& b : kernel.bindings) {
    out << "  {" << std::quoted(b.name) << ", " << b.binding << ", " << std::quoted(b.element) << ", "
        << b.reads << ", " << b.writes << "},\n";
  }
  out << "};\n";
  if (!kernel.push_constants.sizes.empty()) {
    out << "constexpr SizeInfo kSizes" << index << "[] = {\n";
    for (const Size& s : kernel.push_constants.sizes) {
      out << "  {" << std::quoted(s.binding) << ", " << s.offset << "},\n";
    }
    out << "};\n";
  }
  if (kernel.spec_constants.empty()) return;
  out << "constexpr SpecConstantInfo kSpecConstants" << index << "[] = {\n";
  for (const SpecConstant& s : kernel.spec_constants) {
    out << "  {" << std::quoted(s.name) << ", " << s.id << "},\n";
  }
  out << "};\n";
}

void write_list(std::ostream& out, const char* name, std::size_t index, bool is_empty) {
  if (is_empty) {
    out << "{}";
  } else {
    out << name << index;
  }
}

void write_table(std::ostream& out, const std::string& function, const std::vector<Kernel>& kernels) {
  out << "// Written by shaders/embed_spirv.cpp.\n#include \"filter/gpu/program.h\"\n\nnamespace becalm::gpu "
         "{\n"
      << "std::span<const Kernel> " << function << "();\n\nnamespace {\n\n";
  for (std::size_t i = 0; i < kernels.size(); ++i) write_kernel(out, kernels[i], i);
  if (!kernels.empty()) {
    out << "\nconstexpr Kernel kKernels[] = {\n";
    for (std::size_t i = 0; i < kernels.size(); ++i) {
      const Kernel& k = kernels[i];
      const auto& offset = k.push_constants.first_row_offset;
      const std::string first_row = offset ? std::to_string(*offset) : "std::nullopt";
      out << "  {" << std::quoted(k.name) << ", kWords" << i << ", kBindings" << i << ", ";
      write_list(out, "kSpecConstants", i, k.spec_constants.empty());
      out << ", ";
      write_list(out, "kSizes", i, k.push_constants.sizes.empty());
      out << ", " << k.push_constants.constants_offset << ", " << k.push_constants.bytes << ", " << first_row
          << ", {" << k.local_size[0] << ", " << k.local_size[1] << ", " << k.local_size[2] << "}},\n";
    }
    out << "};\n";
  }
  out << "\n}  // namespace\n\nstd::span<const Kernel> " << function << "() { return "
      << (kernels.empty() ? "{}" : "kKernels") << "; }\n\n}  // namespace becalm::gpu\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) {
    std::cerr << "usage: embed_spirv OUT.cpp FUNCTION [NAME FILE.spv]...\n";
    return 2;
  }
  bool failed = false;
  std::vector<Kernel> kernels;
  for (int i = 3; i < argc; i += 2) {
    try {
      kernels.push_back(reflect(argv[i], argv[i + 1]));
    } catch (const std::exception& error) {
      std::cerr << "shader " << argv[i] << ".comp: " << error.what() << '\n';
      failed = true;
    }
  }
  if (failed) return 1;
  std::ranges::sort(kernels, {}, &Kernel::name);
  std::ofstream out(argv[1]);
  write_table(out, argv[2], kernels);
  out.close();
  if (!out) {
    std::cerr << "cannot write " << argv[1] << '\n';
    std::filesystem::remove(argv[1]);
    return 1;
  }
  return 0;
}
