#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/gpu/footprint.h"
#include "filter/gpu/image.h"
#include "filter/gpu/profiler.h"
#include "filter/gpu/program.h"
#include "filter/gpu/tile_rules.h"

namespace becalm::gpu {

/// An image that is kept from frame to frame: a pass writes `next`, which is `previous` in the following
/// frame. `previous` is zero in the first run and after Chain::reset_history. Both share memory if no pass
/// reads `previous` once `next` is written.
struct History {
  ImageId previous;
  ImageId next;
};

/// Device memory that chains hold together. Chains of a device run in turn, so they share what only a run
/// needs.
struct DeviceBytes {
  std::uint64_t own = 0;                    ///< of images that keep their values between runs
  std::vector<std::uint64_t> scratch = {};  ///< by arena: the most that one of the chains needs in a run

  std::uint64_t total() const { return std::accumulate(scratch.begin(), scratch.end(), own); }
  DeviceBytes& operator+=(const DeviceBytes& other) {
    own += other.own;
    scratch.resize(std::max(scratch.size(), other.scratch.size()));
    for (std::size_t i = 0; i < other.scratch.size(); ++i)
      scratch[i] = std::max(scratch[i], other.scratch[i]);
    return *this;
  }
};

/// Where the host writes inputs and reads outputs.
enum class Transfers {
  in_place,  ///< in the memory that kernels use, if the device is a processor; else as `staged`
  staged,    ///< in staging memory, from which and to which runs copy; asked for by tests alone
};

struct ChainOptions {
  bool alias_memory = true;  ///< images whose lifetimes do not overlap share memory
  Transfers transfers = Transfers::in_place;
  /// For tests: no allocation is larger than this, unless a single image is. The device's own limit applies
  /// as well.
  std::uint64_t max_arena_bytes = std::numeric_limits<std::uint64_t>::max();
  std::span<const Kernel> kernels = embedded_kernels();
};

/// A pass as it was declared.
struct DeclaredPass {
  struct Read {
    ImageId image;
    Footprint footprint;
  };
  std::string name;
  std::vector<Read> reads;  ///< and bindings that are read and written
  std::vector<ImageId> writes;
};

/// A fixed sequence of passes over images of known size, built once and run for each frame:
///
///     Chain chain(device, "align");
///     ImageId luma = chain.input("luma.cur", Format::f32, extent);
///     ImageId half = chain.image("luma.cur.L1", Format::f32, half_extent);
///     chain.pass("align/downsample").read("fine", luma, block(2)).write("coarse", half)
///          .specialize("factor", 2).dispatch(half_extent);
///     chain.output(half);
///     chain.build();
///
/// Chains of a device share memory and are used in turn: uploads, a run, downloads.
///
/// Barriers, lifetimes, memory aliasing, debug labels and timestamps are derived from the declarations.
/// `plan`, which `build` calls, checks them: each binding of a kernel is named exactly once, and no other;
/// formats, access and the size of the constants match the kernel; every image is written before it is read.
/// It throws DeviceError naming the pass and the binding, and DeviceLimitError if something is too large for
/// the device.
class Chain {
  struct Impl;

 public:
  /// One pass being declared; `dispatch` completes it.
  class Pass {
   public:
    /// Without an image, the kernel as specialized must not access the binding.
    Pass& read(std::string_view binding, std::optional<ImageId> image, const Footprint& footprint = {});
    Pass& write(std::string_view binding, std::optional<ImageId> image);
    /// Binds one plane. An image that a storage buffer does not hold as a whole is so written plane by plane,
    /// from the first to the last, by one pass or by several.
    Pass& write_plane(std::string_view binding, ImageId image, int plane);
    /// A binding that the kernel both reads, at the written pixel alone, and writes.
    Pass& read_write(std::string_view binding, ImageId image);
    /// Push constants but for sizes, which the chain supplies: a plain struct of shaders/shared/, 4-byte
    /// scalars only.
    template <class Params>
    Pass& constants(const Params& params) {
      static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) <= 128);
      return constant_bytes(std::as_bytes(std::span(&params, 1)));
    }
    Pass& specialize(std::string_view constant, std::int32_t value);
    /// One invocation per pixel of `extent`, rounded up to whole workgroups; kernels check their bounds. If
    /// an invocation computes a block of pixels, pass the extent in blocks.
    void dispatch(Extent extent);

   private:
    friend class Chain;
    Pass(Chain& chain, std::size_t index) : chain_(chain), index_(index) {}
    Pass& constant_bytes(std::span<const std::byte> bytes);
    Chain& chain_;
    std::size_t index_;
  };

  /// The images that a host pass declared to read and to write, while it runs.
  class HostImages {
   public:
    template <class T>
    std::span<const T> read(ImageId image) const {
      return elements<const T>(bytes(image, /*writes=*/false));
    }
    template <class T>
    std::span<T> write(ImageId image) const {
      return elements<T>(bytes(image, /*writes=*/true));
    }

   private:
    friend class Chain;
    HostImages(Impl& chain, std::size_t pass) : chain_(chain), pass_(pass) {}
    template <class T>
    static std::span<T> elements(std::span<std::byte> bytes) {
      return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
    }
    std::span<std::byte> bytes(ImageId image, bool writes) const;
    Impl& chain_;
    std::size_t pass_;
  };

  /// One host pass being declared; `run` completes it.
  class HostPass {
   public:
    HostPass& read(ImageId image, const Footprint& footprint = {});
    HostPass& write(ImageId image);
    /// `work` is called in every run, by the thread that runs the chain, between the preceding and the
    /// following passes. It must write every pixel of the images that it declared to write. Chain::run passes
    /// on its exceptions.
    void run(std::function<void(const HostImages&)> work);

   private:
    friend class Chain;
    HostPass(Chain& chain, std::size_t index) : chain_(chain), index_(index) {}
    Chain& chain_;
    std::size_t index_;
  };

  Chain(Device& device, std::string name, const ChainOptions& options = {});
  ~Chain();
  Chain(Chain&&) noexcept;

  /// A transient image; its memory may be shared with others.
  ImageId image(std::string name, Format format, Extent extent);
  /// An image that the host fills before each run.
  ImageId input(std::string name, Format format, Extent extent);
  /// An input that passes read anywhere and that is the same for all tiles, such as weights or the exposure.
  ImageId table(std::string name, Format format, Extent extent);
  /// Two images, `name`.prev and `name`.next, that swap after each run.
  History history(const std::string& name, Format format, Extent extent);
  /// Makes an image downloadable after a run, with the values of its last writer. `pixel_px` is the side of
  /// its pixel in pixels of the frame.
  void output(ImageId image, int pixel_px = 1);

  Pass pass(std::string_view kernel);
  /// Fills an image with one value.
  void fill(ImageId image, float value);
  /// A pass that runs the program's own code on the images' memory. Only for devices whose is_processor is
  /// set.
  HostPass host_pass(std::string name);
  /// What tiles need for the outputs to be those of the uncut frame, from the footprints of all reads. It
  /// does not depend on the images' sizes. Throws DeviceError if footprints contradict each other.
  TileRules tile_rules() const;
  /// The device that the chain runs on.
  const DeviceInfo& device() const;
  /// Checks the declarations and plans the place of each image in device memory, without allocating any.
  /// device_bytes and staging_bytes then tell what `build` will take. Nothing can be declared afterwards.
  void plan();
  /// Plans, unless that has been done, allocates memory and creates the objects that runs need.
  void build();

  /// Host memory of an input, to be filled before each run. If another chain of the device is built,
  /// destroyed, run or uploaded to before that run, the values may be lost, and run() throws. Tables keep
  /// their values, and uploading to them disturbs no other chain.
  template <class T>
  std::span<T> upload(ImageId image) {
    auto bytes = upload_bytes(image);
    return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// Runs all passes once and waits. History images swap afterwards. Throws DeviceError if an input was not
  /// uploaded for this run, if a run that failed has overwritten the history, if the device is lost, and for
  /// validation messages.
  void run();
  /// An output's pixels. They are valid until any chain of the device is built, destroyed, run, or uploaded
  /// to (except to tables); after that, throws DeviceError.
  template <class T>
  std::span<const T> download(ImageId image) const {
    auto bytes = download_bytes(image);
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// Fills all history images with zero before the next run.
  void reset_history();

  /// For tests of footprints: what was declared, and a chain of one of these passes alone, under the same
  /// ids. Images that the pass reads are inputs; those that it writes are zero before and outputs. Call these
  /// before `plan`.
  std::vector<DeclaredPass> declared_passes() const;
  Extent extent(ImageId image) const;
  Format format(ImageId image) const;
  Chain single_pass(std::size_t pass) const;

  /// Time of each pass of the last run: device time, or host time for host passes.
  const std::vector<PassTime>& times() const;
  /// Device bytes held, or to be held once built, and what they would be if images did not share memory (both
  /// without staging_bytes).
  DeviceBytes device_bytes() const;
  std::uint64_t device_bytes_unaliased() const;
  /// Host memory of inputs and outputs; of tables alone if they are used in place.
  std::uint64_t staging_bytes() const;

 private:
  explicit Chain(std::unique_ptr<Impl> impl);
  std::span<std::byte> upload_bytes(ImageId image);
  std::span<const std::byte> download_bytes(ImageId image) const;
  std::unique_ptr<Impl> impl_;
};

}  // namespace becalm::gpu
