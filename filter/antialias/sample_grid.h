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
  /// Two rows of one f32x4 for each column or row of the scaled image. First row: index of the nearest sample
  /// along the axis; weights of the scaled image's pixel filter at the sample before it, at itself and at the
  /// next. Second row: 0; the same three weights of a wide filter, under which every pixel has a sample.
  std::vector<float> columns;
  std::vector<float> rows;
  Imath::V2f position_px{0.0f, 0.0f};  ///< of the samples in their pixels, on average
};

/// For a frame that covers `window` and holds samples everywhere or in a checkerboard. A sample that averages
/// several places has the mean of their weights along each axis; one of unknown place has the wide filter's
/// alone. At scale 1 a pixel's weights sum to 1 on average.
SparseGrid sparse_grid(const std::optional<FrameJitter>& jitter, const Scale& scale,
                       const Imath::Box2i& window, bool is_checkerboard);

}  // namespace becalm::filter
