#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "filter/gpu/device.h"
#include "filter/report.h"
#include "filter/sequence/schedule.h"
#include "filter/settings.h"
#include "frame/frame.h"

namespace becalm::filter {

struct Denoised {
  Frame frame;  ///< beauty, remaining variance, additive AOVs, and the requested diagnostics
  FrameReport report;
};

/// AOVs that the filter uses if a frame has them, besides the additive ones (merge/additive.h), which it
/// denoises where it is told that they are available. Other AOVs are ignored.
AovSet wanted_aovs(const Settings& settings);

/// Whether the history is also dropped where is_cut finds a cut, in addition to where the schedule says so.
enum class FindCuts { no, yes };

/// What becomes of alpha: passed on as it came, or merged with the beauty's weights where noisy_alpha marks
/// it.
enum class Alpha { keep, denoise };

struct SequenceOptions {
  AovSet diagnostics = {};  ///< diagnostic AOVs in the results
  /// Frames that the device cannot hold whole, or not within so many bytes, are cut into tiles; the results
  /// do not depend on the cut.
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();
  FindCuts find_cuts = FindCuts::no;
  Alpha alpha = Alpha::keep;
  std::size_t light_groups = 0;  ///< of every frame; if 0, light groups are ignored
};

/// Device memory that all filters together may take, in bytes.
std::uint64_t usable_bytes(const gpu::Device& device);

/// Denoises a sequence: every frame is aligned with the history of the frames before it (in backward steps,
/// of those after it) and merged. All frames have the size given at construction and the AOVs of `available`
/// that the filter wants; a frame that differs throws Error(bad_input).
class SequenceFilter {
 public:
  /// Builds the chains for this size. Throws gpu::DeviceError if even the smallest tiles are too large.
  SequenceFilter(gpu::Device& device, const Settings& settings, int width, int height, AovSet available,
                 const SequenceOptions& options = {});
  ~SequenceFilter();
  SequenceFilter(SequenceFilter&&) noexcept;

  /// Runs one step of a schedule. Call it for the steps of a segment in order; `frame` is the step's frame.
  /// Wanted forward steps return the denoised frame. Smoothed frames are kept until the last step that needs
  /// them, predictions from the backward step to the forward step of their frame. Each takes some 12 bytes
  /// per pixel, 24 more with smooth=merged, and 16 for each additive AOV, for each frame of a segment.
  std::optional<Frame> run(const Step& step, const Frame& frame, FrameReport& report);

  /// Runs a wanted forward step.
  Denoised denoise(const Frame& frame);

  /// Drops the history: the next frame starts a new one, as after a cut or a missing frame.
  void reset();

  /// The merge's tiles, and the device memory held by all chains. The tile plan is `1` if no chain cuts the
  /// frame; else it names each chain that does.
  FilterMemory memory() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
