#include "filter/smooth/convolution.h"

#include <algorithm>
#include <cassert>

#include "filter/ceil_div.h"
#include "shaders/shared/convolve_params.h"

namespace becalm::filter {
namespace {

using params::kBlock;
using params::kPlanesMade;

constexpr int kOutputsMade = kPlanesMade * kPlane;
constexpr int kMostPlanes = 4;  // read by one pass; kernels that read more take seconds to compile

float direct_weight(const Layer& layer, int output, int input, int tap) {
  return layer.at(output, input, tap / 3, tap % 3);
}

/// Weights that replace the nine taps on an image of half the size: for each of the pixels (y % 2, x % 2),
/// the sums of the taps that fall on each of 2x2 coarse pixels.
float upsampled_weight(const Layer& layer, int output, int input, int tap) {
  const int y = tap / 8;
  const int x = tap / 4 % 2;
  double sum = 0.0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const bool falls_on = (y + row + 1) / 2 - y == tap / 2 % 2 && (x + column + 1) / 2 - x == tap % 2;
      if (falls_on) sum += layer.at(output, input, row, column);
    }
  }
  return static_cast<float>(sum);
}

}  // namespace

Convolution::Convolution(const Layer& layer, int upsampled_inputs) : outputs_(layer.outputs) {
  assert(layer.side == 3 && layer.inputs % kPlane == 0 && upsampled_inputs % kPlane == 0 &&
         layer.outputs % kOutputsMade == 0);
  direct_ =
      pack(layer, upsampled_inputs, layer.inputs - upsampled_inputs, params::kDirectTaps, direct_weight);
  upsampled_ = pack(layer, 0, upsampled_inputs, params::kUpsampledTaps, upsampled_weight);
}

/// Appends the weights of the passes over `inputs` channels of the layer from `first_input` on, which are the
/// first channels of the source. The layer's first pass has the bias.
template <class WeightOf>
std::vector<Convolution::Part> Convolution::pack(const Layer& layer, int first_input, int inputs, int taps,
                                                 const WeightOf& weight_of) {
  std::vector<Part> parts;
  for (int plane = 0; plane < inputs / kPlane; plane += kMostPlanes) {
    const Part part{.first_plane = plane,
                    .planes = std::min(kMostPlanes, inputs / kPlane - plane),
                    .first_weight = static_cast<int>(weights_.size()) / kPlane};
    const bool has_bias = weights_.empty();
    const int begin = first_input + plane * kPlane;
    for (int first_output = 0; first_output < layer.outputs; first_output += kOutputsMade) {
      const int end_output = first_output + kOutputsMade;
      for (int o = first_output; o < end_output; ++o) weights_.push_back(has_bias ? layer.bias[o] : 0.0f);
      for (int input = begin; input < begin + part.planes * kPlane; ++input) {
        for (int tap = 0; tap < taps; ++tap) {
          for (int o = first_output; o < end_output; ++o) weights_.push_back(weight_of(layer, o, input, tap));
        }
      }
    }
    parts.push_back(part);
  }
  return parts;
}

gpu::ImageId Convolution::add_passes(gpu::Chain& chain, const std::string& name, gpu::Extent size,
                                     gpu::ImageId weights, gpu::ImageId source, gpu::ImageId coarse) const {
  const int planes = outputs_ / kPlane;
  const gpu::ImageId result = chain.image(name, gpu::Format::f32x4, size.with_planes(planes));
  const std::size_t count = direct_.size() + upsampled_.size();
  std::size_t done = 0;
  const auto add = [&](std::string_view kernel, gpu::ImageId from, const gpu::Footprint& footprint,
                       const Part& part, gpu::Extent invocations) {
    gpu::Chain::Pass pass = chain.pass(kernel);
    pass.read("source", from, footprint).read("weights", weights);
    done == 0 ? pass.write("result", result) : pass.read_write("result", result);
    ++done;
    pass.specialize("planes", part.planes)
        .constants(params::ConvolveParams{.first_plane = part.first_plane,
                                          .first_weight = part.first_weight,
                                          .rectify = done == count ? 1 : 0})
        .dispatch(invocations.with_planes(planes / kPlanesMade));
  };
  const int columns = ceil_div(size.width, kBlock);
  for (const Part& part : direct_) {
    add(done == 0 ? "smooth/convolve" : "smooth/convolve_onto", source, gpu::reach(1), part,
        {columns, size.height});
  }
  for (const Part& part : upsampled_) {
    add("smooth/convolve_upsampled", coarse, gpu::coarser(2, 1), part,
        {columns, ceil_div(size.height, kBlock)});
  }
  return result;
}

}  // namespace becalm::filter
