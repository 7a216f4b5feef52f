#include "filter/smooth/own_share.h"

#include "filter/ceil_div.h"
#include "filter/merge/patch_sums.h"

namespace becalm::filter {
namespace {

/// Radius of the patches over which differences are averaged.
constexpr int kRadius = 3;
constexpr int kVector = 4;

}  // namespace

OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame,
                       const SmoothEstimate& estimate, gpu::ImageId weights) {
  using gpu::Format;
  const gpu::ImageId difference = chain.image("own.difference", Format::f32x4, full);
  chain.pass("smooth/difference")
      .read("frame", frame.own_color)
      .read("variance", frame.variance)
      .read("estimate", estimate.color)
      .read("estimate_stats", estimate.stats)
      .read("exposure", frame.exposure)
      .read("detail", estimate.detail)
      .write("difference", difference)
      .specialize("has_detail", estimate.detail ? 1 : 0)
      .dispatch(full);
  const gpu::ImageId sums = add_box_sums(chain, kRadius, full, difference, "own.difference");
  const OwnShare own{.share = chain.image("own.share", Format::f32, full),
                     .stats = chain.image("own.stats", Format::f32x2, full)};
  chain.pass("smooth/own_share")
      .read("difference", difference)
      .read("difference_sums", sums)
      .read("estimate", estimate.color)
      .read("estimate_stats", estimate.stats)
      .read("exposure", frame.exposure)
      .read("weights", weights)
      .read("fade", estimate.fade)
      .write("share", own.share)
      .write("stats", own.stats)
      .specialize("fades", estimate.fade ? 1 : 0)
      .dispatch(full);
  return own;
}

std::vector<float> pack_own_share(const OwnShareWeights& layers) {
  std::vector<float> values;
  for (const Layer& layer : layers) {
    const int padded = ceil_div(layer.outputs, kVector) * kVector;
    for (int input = -1; input < layer.inputs; ++input) {
      for (int output = 0; output < padded; ++output) {
        const bool exists = output < layer.outputs;
        values.push_back(!exists ? 0.0f : input < 0 ? layer.bias[output] : layer.at(output, input));
      }
    }
  }
  return values;
}

}  // namespace becalm::filter
