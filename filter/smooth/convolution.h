#pragma once

#include <string>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

/// Channels of a plane of an image: channel c of a pixel is component c % 4 of plane c / 4.
constexpr int kPlane = 4;

/// A 3x3 convolution with bias and ReLU that repeats the image's border, as the passes of
/// shaders/smooth/convolve*.comp. It reads images of its own size or, before their channels, one of half the
/// size, each pixel of which stands for 2x2.
class Convolution {
 public:
  /// Packs the layer's weights. Its first `upsampled_inputs` channels are those of the image of half the
  /// size. Inputs come in fours, outputs in eights.
  explicit Convolution(const Layer& layer, int upsampled_inputs = 0);

  /// The packed weights, for an image of vectors of four.
  const std::vector<float>& weights() const { return weights_; }

  /// Declares the passes. `weights` is the image that weights() go to; the result (f32x4) has `size`.
  /// `coarse` is read if there are upsampled inputs.
  gpu::ImageId add_passes(gpu::Chain& chain, const std::string& name, gpu::Extent size, gpu::ImageId weights,
                          gpu::ImageId source, gpu::ImageId coarse = {}) const;

 private:
  /// Where one pass finds its weights, and what it reads.
  struct Part {
    int first_plane = 0;  ///< of the pass's source
    int planes = 0;
    int first_weight = 0;  ///< in vectors of four
  };

  template <class WeightOf>
  std::vector<Part> pack(const Layer& layer, int first_input, int inputs, int taps,
                         const WeightOf& weight_of);

  int outputs_;
  std::vector<float> weights_;
  std::vector<Part> direct_;     ///< over the source of the result's size
  std::vector<Part> upsampled_;  ///< over the source of half the size
};

}  // namespace becalm::filter
