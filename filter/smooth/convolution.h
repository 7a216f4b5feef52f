#pragma once

#include <string>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

/// Channels of a plane of an image: channel c of a pixel is component c % 4 of plane c / 4.
constexpr int kPlane = 4;

/// A 3x3 convolution with bias and ReLU that repeats the image's border, declared as passes of
/// shaders/smooth/convolve*.comp. Its input is an image of the result's size. Channels of an image of half
/// the size may come before those channels; each of its pixels covers 2x2 pixels.
class Convolution {
 public:
  /// Packs the layer's weights. Its first `upsampled_inputs` channels are those of the image of half the
  /// size. The number of inputs is a multiple of 4, that of outputs of 8.
  explicit Convolution(const Layer& layer, int upsampled_inputs = 0);

  /// The packed weights, for an image of vectors of four.
  const std::vector<float>& weights() const { return weights_; }

  /// Declares the passes. `weights` is the image that holds weights(); the result (f32x4) has `size`.
  /// `coarse` is read if there are upsampled inputs.
  gpu::ImageId add_passes(gpu::Chain& chain, const std::string& name, gpu::Extent size, gpu::ImageId weights,
                          gpu::ImageId source, gpu::ImageId coarse = {}) const;

 private:
  /// The planes and the weights that one pass reads.
  struct Part {
    int first_plane = 0;  ///< in the pass's source
    int planes = 0;
    int first_weight = 0;  ///< in vectors of four
  };

  template <class WeightOf>
  std::vector<Part> pack(const Layer& layer, int first_input, int inputs, int taps,
                         const WeightOf& weight_of);

  int outputs_;
  std::vector<float> weights_;
  std::vector<Part> direct_;     ///< passes over the source of the result's size
  std::vector<Part> upsampled_;  ///< passes over the source of half the size
};

}  // namespace becalm::filter
