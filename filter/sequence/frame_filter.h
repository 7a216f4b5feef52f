#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <limits>
#include <optional>

#include "filter/report.h"
#include "filter/sequence/schedule.h"
#include "frame/frame.h"

namespace becalm::filter {

/// Filters a sequence by the steps of a schedule.
class FrameFilter {
 public:
  virtual ~FrameFilter() = default;
  /// Runs one step. Call it for the steps of a segment in order; `frame` is the step's frame. Wanted forward
  /// steps return the filtered frame.
  virtual std::optional<Frame> run(const Step& step, const Frame& frame, FrameReport& report) = 0;
  /// The tiles, and the device memory held.
  virtual FilterMemory memory() const = 0;
};

/// Whether the history is also dropped where is_cut finds a cut, in addition to where the schedule says so.
enum class FindCuts { no, yes };

/// What becomes of alpha: passed on as it came, or merged with the beauty's weights and then smoothed, by a
/// preset that smooths, where noisy_alpha marks it.
enum class Alpha { keep, denoise };

struct SequenceOptions {
  AovSet diagnostics = {};  ///< diagnostic AOVs in the results
  /// Frames that the device cannot hold whole, or not within so many bytes, are cut into tiles; the results
  /// do not depend on the cut.
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();
  FindCuts find_cuts = FindCuts::no;
  Alpha alpha = Alpha::keep;
  std::size_t light_groups = 0;  ///< of every frame; if 0, light groups are ignored
  /// Of the frames' first pixel in the image plane, to which results of another size are aligned.
  Imath::V2i origin{0, 0};
};

}  // namespace becalm::filter
