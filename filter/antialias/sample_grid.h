#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <optional>
#include <vector>

#include "frame/jitter.h"
#include "frame/scale.h"

namespace becalm::filter {

/// How the samples of a jittered frame lie around pixel centres. The frame is shifted by whole pixels so that
/// each pixel holds the sample nearest to its centre.
struct SampleGrid {
  Imath::V2i shift{0, 0};  ///< pixel p of the shifted frame is pixel p + shift of the frame
  /// Weights of the pixel filter at the samples of the 3x3 pixels, row-major; then 1 if the samples' place is
  /// known and unique, else 0: pixels are then their own samples.
  std::array<float, 10> weights{0, 0, 0, 0, 1, 0, 0, 0, 0, 0};
};

SampleGrid sample_grid(const std::optional<FrameJitter>& jitter);

/// How samples lie around the pixels of an image of another size, or of one of which only some pixels have
/// samples, along both axes.
struct SparseGrid {
  /// Of the scaled image's columns and rows, 8 values each: the number of the nearest sample along the axis,
  /// then the weights of the pixel filter, which is as wide as the scaled image's pixels ask for, at that
  /// sample's last, itself and next; 0, and the weights of a filter that finds samples everywhere.
  std::vector<float> columns;
  std::vector<float> rows;
  Imath::V2f position_px{0.0f, 0.0f};  ///< of the samples in their pixels, on average
};

/// For a frame that covers `window` and holds samples everywhere or in a checkerboard. What is the mean of
/// samples of several places weighs, along each axis, by the mean of their filters, and samples whose place
/// is not known by the second filter alone. The product of a pixel's weights is, summed over samples, 1 on
/// average over the pixels of a frame of scale 1.
SparseGrid sparse_grid(const std::optional<FrameJitter>& jitter, const Scale& scale,
                       const Imath::Box2i& window, bool is_checkerboard);

}  // namespace becalm::filter
