#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "filter/gpu/image.h"
#include "frame/frame.h"

namespace becalm::filter {

/// Radiance of a frame's pixels with its variance and effective sample count.
struct Estimate {
  Estimate() = default;
  /// Pixels are not set.
  Estimate(gpu::Extent extent, std::size_t carried_count)
      : color(extent.width, extent.height, 4, Unfilled()), stats(extent.width, extent.height, 2, Unfilled()) {
    for (std::size_t i = 0; i < carried_count; ++i)
      carried.emplace_back(extent.width, extent.height, 4, Unfilled());
  }

  Image color;  ///< four channels
  Image stats;  ///< (variance, effective sample count); a count of 0 means no data
  /// Images merged with the beauty's weights, four channels each: the additive AOVs; in the merge also the
  /// noisy layers, if the task smooths merged frames.
  std::vector<Image> carried;
  /// Of a smoothed frame that came without variance: (variance, valid) of its noise, as
  /// MergeInputs::variance, if the merge reads it.
  Image noise = {};
};

/// A frame prepared as input of the chains.
struct NewFrame {
  const Frame& frame;
  const NewFrame* own = nullptr;     ///< of a merged frame: the unmerged one
  std::vector<std::uint8_t> finite;  ///< from finite_pixels
  float exposure;                    ///< of the whole frame, from exposure()
  float usual_depth = 1.0f;          ///< from typical_depth
  float noise_ratio = 1.0f;          ///< from input/noise_ratio.h
  std::vector<Image> additive = {};  ///< from pack_additive
  Estimate smoothed = {};            ///< if not empty, matched and merged instead of the frame
  Image smoothed_albedo = {};        ///< RGB; if not empty, stands for the frame's albedo
  Image motion = {};                 ///< offset into the history, as Aov::motion; empty if no motion is used

  const Image& albedo() const { return smoothed_albedo.empty() ? frame.image(Aov::albedo) : smoothed_albedo; }
  const std::vector<Image>& merged_additive() const {
    return smoothed.carried.empty() ? additive : smoothed.carried;
  }
};

}  // namespace becalm::filter
