#pragma once

#include <memory>

#include "filter/smooth/weights.h"

namespace becalm::filter {

/// A 3x3 convolution with bias and ReLU, computed by oneDNN on the processor, one row of pixels per call. The
/// channels of a pixel are consecutive. Images are framed: one extra pixel at either end of a row, and one
/// extra row above and below, repeat the image's border. The first channels may be those of an image of half
/// the size, each of whose pixels covers 2x2 pixels. A row's result depends neither on the image's height nor
/// on the calling thread.
class HostConvolution {
 public:
  /// Throws gpu::DeviceError if oneDNN fails. `width` excludes the frame; it must be even if there are
  /// upsampled inputs.
  HostConvolution(const Layer& layer, int upsampled_inputs, int width);
  ~HostConvolution();

  /// Computes rows on one thread, with oneDNN objects that are made once for all rows. Several threads may
  /// each have their own `Rows` of one convolution, which must outlive them.
  class Rows {
   public:
    explicit Rows(const HostConvolution& convolution);
    ~Rows();

    /// Computes row `y`, counted from 0. `source` and `coarse` begin with the framed row above row 0;
    /// `coarse` is the image of half the size. `result` is a framed row; its first and last pixel are
    /// undefined. Throws gpu::DeviceError if oneDNN fails.
    void make(int y, const float* source, const float* coarse, float* result);

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace becalm::filter
