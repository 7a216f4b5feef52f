#pragma once

#include <cstdint>
#include <vector>

#include "filter/estimate.h"
#include "filter/gpu/chain.h"
#include "filter/tiles/local_chain.h"

namespace becalm::filter {

/// Two estimates of a frame: colours are f32x4, statistics f32x2 of (variance, effective sample count; a
/// count of 0 means no data).
struct CombineInputs {
  gpu::ImageId exposure;       ///< f32, 1x1
  gpu::ImageId forward_color;  ///< from the frame and the frames before it
  gpu::ImageId forward_stats;
  gpu::ImageId backward_color;  ///< from the frames after it
  gpu::ImageId backward_stats;
  std::vector<gpu::ImageId> forward_carried = {};  ///< carried images, f32x4
  std::vector<gpu::ImageId> backward_carried = {};
};

struct Combined {
  gpu::ImageId color;
  gpu::ImageId stats;
  std::vector<gpu::ImageId> carried = {};
};

/// The fixed-interval smoother: the mean of both estimates of a frame, weighted by the inverse of their
/// variances.
Combined add_combine_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent extent,
                            const CombineInputs& inputs);

/// Combines the forward estimate of a frame with the prediction from the frames after it, tile by tile.
class Combiner {
 public:
  /// Plans the largest tiles that take at most `memory_limit` bytes. Throws DeviceLimitError if even the
  /// smallest tiles take more.
  Combiner(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);
  ~Combiner();

  /// `forward` includes the frame, `prediction` does not; `exposure` is the frame's. Adds the device times to
  /// the report.
  Estimate run(float exposure, Estimate forward, Estimate prediction, FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Passes;
  FilterTask task_;
  LocalChain<Passes> chain_;
};

}  // namespace becalm::filter
