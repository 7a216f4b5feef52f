#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "filter/gpu/image.h"
#include "frame/frame.h"

namespace becalm::filter {

/// What is known of a frame's pixels, and how well.
struct Estimate {
  Estimate() = default;
  Estimate(gpu::Extent extent, std::size_t carried_count)
      : color(extent.width, extent.height, 4),
        stats(extent.width, extent.height, 2),
        additive(carried_count, color) {}

  Image color;  ///< four channels
  Image stats;  ///< (variance, effective sample count); a count of 0 where nothing is known
  /// What goes with the beauty's weights, four channels each: additive AOVs; in the merge also the noisy
  /// layers, if the task smooths what is merged.
  std::vector<Image> additive;
};

/// A frame on its way into the chains.
struct NewFrame {
  const Frame& frame;
  const NewFrame* own = nullptr;     ///< of merged frames, the one itself
  std::vector<std::uint8_t> finite;  ///< of finite_pixels
  float exposure;                    ///< of the whole frame
  float usual_depth = 1.0f;          ///< of typical_depth
  std::vector<Image> additive = {};  ///< of pack_additive
  Estimate smoothed = {};            ///< what is matched and merged in place of the frame, if not empty

  const std::vector<Image>& merged_additive() const {
    return smoothed.additive.empty() ? additive : smoothed.additive;
  }
};

}  // namespace becalm::filter
