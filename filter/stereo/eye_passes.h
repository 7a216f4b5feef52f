#pragma once

#include <optional>
#include <vector>

#include "filter/align/align.h"
#include "filter/estimate.h"
#include "filter/gpu/chain.h"
#include "filter/merge/estimate_inputs.h"
#include "filter/merge/merge.h"
#include "filter/task.h"
#include "filter/tiles/tiles.h"

namespace becalm::filter {

/// What is known of one eye's frame, all of one size.
struct EyeFrame {
  const NewFrame& frame;
  const Estimate& estimate;
};

/// The chain that combines an eye's estimate of a frame, or of a tile of it, with the other eye's.
struct EyePasses {
  /// `target` is the size of the own estimate's images, `source` of the other's. Offsets into the other eye's
  /// image have components of at most `limit_px`.
  EyePasses(gpu::Device& device, const FilterTask& task, int limit_px, gpu::Extent target,
            gpu::Extent source);

  /// Uploads what a tile reads of the other eye.
  void upload_other(const EyeFrame& eye, const Rect& rect);

  gpu::Chain chain;
  gpu::ImageId exposure;  ///< f32, 1x1: of the own frame
  gpu::Extent extent;     ///< of the own images
  SourceWindow window;
  EstimateInputs own;
  EstimateInputs other;
  std::optional<gpu::ImageId> other_depth;     ///< if frames have it
  gpu::ImageId offset;                         ///< f32x2, into the other eye's image
  std::optional<gpu::ImageId> expected_depth;  ///< f32, there; 0: not known
  gpu::ImageId color;                          ///< output, f32x4, as the next three: the combined estimate
  gpu::ImageId stats;                          ///< f32x2, as Estimate::stats
  gpu::ImageId weight;                         ///< f32, in [0,1]: of the other eye
  std::vector<gpu::ImageId> carried;           ///< f32x4

 private:
  gpu::ImageId add_depth_check(int limit_px);
  void add_blend(const FilterTask& task, const WarpedHistory& warped);
};

}  // namespace becalm::filter
