#pragma once

#include <memory>

#include "filter/smooth/weights.h"

namespace becalm::filter {

/// A 3x3 convolution with bias and ReLU, made by oneDNN on the processor, a row of pixels a call. The
/// channels of a pixel lie behind one another, and rows are framed: a pixel more at either end, and a row
/// more above and below, repeat the image's border. The channels that come first may be those of an image of
/// half the size, each pixel of which stands for 2x2. A row comes out the same whatever its image's height
/// and whoever makes it.
class HostConvolution {
 public:
  /// Throws gpu::DeviceError for oneDNN's errors. `width` without the frame; even if there are upsampled
  /// inputs.
  HostConvolution(const Layer& layer, int upsampled_inputs, int width);
  ~HostConvolution();

  /// Makes row `y`, which counts from 0, from the framed rows of the source, which begin with that above row
  /// 0, and those of the image of half the size. All pixels of `result`, a framed row, are written; the
  /// frame's are not of any use. May be called by several threads at once.
  void make_row(int y, const float* source, const float* coarse, float* result) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace becalm::filter
