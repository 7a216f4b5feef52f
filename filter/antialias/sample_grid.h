#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <optional>

#include "frame/jitter.h"

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

}  // namespace becalm::filter
