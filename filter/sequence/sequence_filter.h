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
  Frame frame;  ///< beauty, the variance left, additive AOVs, and the diagnostics asked for
  FrameReport report;
};

/// AOVs that the filter uses when a frame has them, besides the additive ones (merge/additive.h), which it
/// denoises if `additive` is set; what else a frame carries is ignored.
AovSet wanted_aovs(const Settings& settings);

/// Whether histories start anew where is_cut finds a cut, besides where the schedule says so.
enum class FindCuts { no, yes };

/// The bytes of a device that filters may take, all together.
std::uint64_t usable_bytes(const gpu::Device& device);

/// Denoises a sequence: every frame is aligned with the history of the frames before it, or after it, and
/// merged. All frames have the size given at construction and the AOVs of `available` that the filter wants;
/// a frame that differs throws Error(bad_input).
class SequenceFilter {
 public:
  /// Builds the chains for this size. `diagnostics` are those of the AOV table's to put into the
  /// results. Frames that the device cannot hold whole, or not within `memory_limit` bytes, are cut
  /// into tiles, which the results do not show. Every frame has `light_groups` of them. Throws
  /// gpu::DeviceError if the smallest tiles are still too large.
  SequenceFilter(gpu::Device& device, const Settings& settings, int width, int height, AovSet available,
                 AovSet diagnostics = {},
                 std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max(),
                 FindCuts find_cuts = FindCuts::no, std::size_t light_groups = 0);
  ~SequenceFilter();
  SequenceFilter(SequenceFilter&&) noexcept;

  /// Takes one step of a schedule; the steps of a segment come in their order, and `frame` is the step's.
  /// Steps forward that are wanted return the denoised frame. Smoothed frames are kept until the last step
  /// that needs them, predictions from the step backward that wants them to the step forward that takes them:
  /// some 12 bytes a pixel each, 24 more with smooth=merged, and 16 for each additive AOV, for each frame of
  /// a segment.
  std::optional<Frame> run(const Step& step, const Frame& frame, FrameReport& report);

  /// A step forward of a frame that is wanted.
  Denoised denoise(const Frame& frame);

  /// Forgets the history: the next frame starts anew, as after a cut or a missing frame.
  void reset();

  /// How the frames are cut, and the device memory held for it.
  FilterMemory memory() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
