#pragma once

// Private to filter/gpu/: the members of a Chain. chain.cpp declares and runs, chain_footprints.cpp tells how
// far passes read, chain_check.cpp checks, chain_build.cpp plans memory and creates the Vulkan objects,
// chain_record.cpp records the commands.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "filter/gpu/chain.h"
#include "filter/gpu/device_impl.h"
#include "filter/gpu/hazards.h"
#include "filter/gpu/profiler_impl.h"
#include "filter/gpu/program_impl.h"
#include "filter/gpu/scratch.h"

namespace becalm::gpu {

enum class Role { transient, input, history_previous, history_next };
enum class Access { read, write, read_write };

struct ImageDeclaration {
  std::string name;
  Format format;
  Extent extent;
  Role role;
  bool is_table = false;
  bool is_output = false;
  int pixel_px = 1;  ///< of an output
  int partner = -1;  ///< of a history image: the other one of the pair
  /// Of the next image of a history: it takes the memory of the previous one, which is no longer read once it
  /// is written.
  bool replaces_previous = false;

  std::uint64_t bytes() const { return extent.elements() * bytes_per_element(format); }
  std::uint64_t plane_bytes() const { return extent.with_planes(1).elements() * bytes_per_element(format); }
  bool is_history() const { return role == Role::history_previous || role == Role::history_next; }
};

/// Throws DeviceLimitError if `bytes`, which the image takes, are more than a limit: those that the device
/// can `verb`.
void require_bytes(const ImageDeclaration& image, std::uint64_t bytes, std::uint64_t limit,
                   const std::string& device_name, const std::string& where, const char* verb);

struct Use {
  std::string binding;
  int image;
  Access access;
  Footprint footprint = {};
  std::optional<int> plane = {};  ///< the one that is written, if not all are

  bool reads() const { return access != Access::write; }
  bool writes() const { return access != Access::read; }
};

/// What runs a pass: a kernel on the device, the program's own code, or the device's fill command.
enum class PassKind { kernel, host, fill };

struct PassDeclaration {
  std::string name;  ///< of the kernel, or of the host pass
  PassKind kind = PassKind::kernel;
  std::uint32_t fill_bits = 0;                         ///< of a fill
  std::function<void(const Chain::HostImages&)> work;  ///< of a host pass
  const Kernel* kernel = nullptr;                      ///< found by check(); null for other kinds
  std::vector<Use> uses;
  std::vector<std::string> absent;        ///< bindings that the kernel as specialized does not access
  std::vector<std::byte> constants;       // as declared
  std::vector<std::byte> push_constants;  // the kernel's: sizes, then `constants`; made by check()
  std::vector<std::pair<std::string, std::int32_t>> specializations;
  std::optional<Extent> extent;
  int band_rows = 0;  ///< of a kernel, made by check(): rows_of_band. The last band may have fewer

  int bands() const { return (extent->height + band_rows - 1) / band_rows; }
  int first_row(int band) const { return band * band_rows; }
  int rows(int band) const { return std::min(band_rows, extent->height - first_row(band)); }
};

/// How many rows one dispatch of the pass makes: as many as storage buffers of `limit_bytes` hold of each
/// image that it writes. All rows if they hold them, or if the kernel cannot make a part of them.
int rows_of_band(const PassDeclaration& pass, const std::vector<ImageDeclaration>& images,
                 std::uint64_t limit_bytes, const std::string& where);

struct BufferPart {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

/// What is bound of an image for one band: the band's rows if the pass writes it in bands, the plane if it
/// writes one, else all of it.
BufferPart part_of_band(const PassDeclaration& pass, const Use& use, const ImageDeclaration& image, int band);

std::vector<std::byte> push_constants_of_band(const PassDeclaration& pass, int band);

/// One step of a run. Staged inputs are uploaded just before their first reader and outputs downloaded just
/// after their last writer, so that neither holds device memory longer than necessary.
struct Step {
  enum class Kind { upload, pass, download } kind;
  int index;  ///< of the image or of the pass
};

/// The first and the last step during which an image has memory.
struct Lifetime {
  int first;
  int last;
};

/// A run is a list of segments: commands for the device, then at most one host pass.
struct Segment {
  std::size_t first_step = 0;
  std::size_t end_step = 0;  ///< one past its last step for the device
  int host_pass = -1;
  std::array<vk::raii::CommandBuffer, 2> commands = {nullptr, nullptr};  ///< by parity

  bool has_commands() const { return end_step > first_step; }
};

/// An image's device memory, first planned, then allocated. The images of a history swap: see
/// Chain::Impl::buffer.
struct DeviceBuffer {
  vk::raii::Buffer buffer = nullptr;
  vk::raii::BufferView texels = nullptr;  ///< null if the device cannot read so many elements as texels
  int arena = 0;                          ///< of those that Chain::Impl numbers
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;      ///< 0: the image needs no memory
  std::byte* mapped = nullptr;  ///< host address, if the chain's memory is mapped
};

struct PassPipeline {
  vk::Pipeline pipeline;
  vk::PipelineLayout layout;
};

/// Number of workgroups of `local_size` invocations that cover `pixels`.
constexpr std::uint32_t workgroups(int pixels, std::uint32_t local_size) {
  return (static_cast<std::uint32_t>(pixels) + local_size - 1) / local_size;
}

struct Chain::Impl {
  Impl(Device& device, std::string name, const ChainOptions& options)
      : Impl(device.impl(), std::move(name), options) {}
  Impl(Device::Impl& device, std::string name, const ChainOptions& options)
      : device(device), name(std::move(name)), options(options) {}
  ~Impl();

  std::string label() const { return "chain '" + name + "'"; }
  std::string label(std::size_t pass) const;
  ImageId declare(std::string image_name, Format format, Extent extent, Role role);
  void require_declaring() const;
  const ImageDeclaration& image(ImageId id) const;

  void check();

  void plan_steps();
  void plan_segments();
  /// By image; none of images that need no memory. Used in place, inputs have it from the first step on and
  /// outputs to the last one.
  std::vector<std::optional<Lifetime>> lifetimes() const;
  void find_replaced_histories(const std::vector<std::optional<Lifetime>>& lived);
  void plan_memory();
  void allocate();
  void bind_image(std::size_t image, const vk::raii::DeviceMemory& memory, std::byte* mapped);
  /// Records what depends on the device's scratch memory, unless that is done for the present one.
  void bind_scratch();
  /// Takes the device's scratch memory for the inputs and outputs of this chain.
  void take_scratch();
  /// Inputs but for tables must be uploaded again.
  void forget_inputs();
  void create_staging();
  void create_pipelines();
  void create_nothing();
  void bind(vk::DescriptorSet set, const BindingInfo& binding, const vk::DescriptorBufferInfo& part,
            vk::BufferView texels) const;
  void create_descriptor_sets();
  void declare_times();
  void record_all();
  void record(const Segment& segment, int parity) const;
  void record_pass(const vk::raii::CommandBuffer& commands, std::size_t pass, int parity) const;
  void record_reset(const vk::raii::CommandBuffer& commands) const;
  std::vector<MemoryAccess> accesses(const Step& step, int parity) const;
  void run_segments();
  void submit(const Segment& segment);

  /// Whether the host uses inputs and outputs where they lie on the device.
  bool is_in_place() const { return device.info.is_processor && options.transfers == Transfers::in_place; }
  bool is_mapped() const { return has_host_passes || is_in_place(); }
  /// Whether the image has memory of its own, since it keeps its values between runs.
  bool is_kept(const ImageDeclaration& declared) const {
    return declared.is_history() || (is_in_place() && declared.is_table);
  }

  bool is_scratch(const DeviceBuffer& planned) const {
    return static_cast<std::size_t>(planned.arena) < scratch_bytes.size();
  }

  /// The buffer of an image in frames of this parity. The two buffers of a history swap every frame.
  const DeviceBuffer& buffer(int image, int parity) const {
    const ImageDeclaration& declared = images[static_cast<std::size_t>(image)];
    return buffers[static_cast<std::size_t>(parity == 1 && declared.is_history() ? declared.partner : image)];
  }

  Device::Impl& device;
  std::string name;
  ChainOptions options;
  std::vector<ImageDeclaration> images;
  std::vector<PassDeclaration> passes;
  bool is_planned = false;
  bool is_built = false;
  bool has_history = false;
  bool replaces_history = false;  // what a run begins with is lost once it ends
  bool has_host_passes = false;

  std::vector<Step> steps;
  // Arenas are numbered: those of the device's scratch memory, then those of the chain alone.
  std::vector<std::uint64_t> scratch_bytes;
  std::vector<std::uint64_t> own_bytes;  // of each image that is kept
  std::uint32_t memory_type = 0;
  std::shared_ptr<const Scratch::Sizes> reservation;  // of the scratch memory; null before `build`
  std::uint64_t scratch_version = 0;                  // of what is recorded; 0 before the first run
  std::vector<vk::raii::DeviceMemory> own;
  std::vector<DeviceBuffer> buffers;  // one per image
  std::vector<HostBuffer> staging;    // one per image; null except for staged inputs and outputs
  std::vector<bool> is_filled;        // one per image: it was uploaded, since the last run unless a table
  DeviceBytes bytes;
  std::uint64_t device_bytes_unaliased = 0;
  std::uint64_t staging_bytes = 0;

  std::vector<PassPipeline> pipelines;  // one per pass; null for passes without a kernel
  HostBuffer nothing;                   // bound to absent bindings; null if there are none
  vk::raii::BufferView nothing_texels = nullptr;
  vk::raii::DescriptorPool descriptor_pool = nullptr;
  std::array<std::vector<std::vector<vk::raii::DescriptorSet>>, 2> descriptor_sets;  // by parity, pass, band
  std::optional<PassTimer> timer;
  vk::raii::CommandPool command_pool = nullptr;
  std::vector<Segment> segments;  // declared after the pool, since they hold its buffers
  vk::raii::CommandBuffer reset_commands = nullptr;
  vk::raii::Fence fence = nullptr;

  int parity = 0;
  int last_parity = 0;  // of the last run
  bool needs_reset = true;
  bool has_run = false;
  bool history_is_lost = false;  // by a run that failed
  bool holds_outputs = false;    // of the last run
  std::vector<PassTime> times;
};

}  // namespace becalm::gpu
