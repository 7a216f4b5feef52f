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
                       const SmoothedMerged& merged, gpu::ImageId weights) {
  using gpu::Format;
  const gpu::ImageId difference = chain.image("own.difference", Format::f32x4, full);
  chain.pass("smooth/difference")
      .read("frame", frame.own_color)
      .read("variance", frame.variance)
      .read("merged", merged.color)
      .read("merged_error", merged.stats)
      .read("exposure", frame.exposure)
      .read("detail", merged.detail)
      .write("difference", difference)
      .dispatch(full);
  const gpu::ImageId sums = add_patch_sums(chain, kRadius, full, difference, "own.difference");
  const OwnShare own{.share = chain.image("own.share", Format::f32, full),
                     .stats = chain.image("own.stats", Format::f32x2, full)};
  chain.pass("smooth/own_share")
      .read("difference", difference, gpu::reach(kRadius, 0))
      .read("difference_sums", sums)
      .read("merged", merged.color)
      .read("merged_error", merged.stats)
      .read("exposure", frame.exposure)
      .read("weights", weights)
      .write("share", own.share)
      .write("stats", own.stats)
      .specialize("radius", kRadius)
      .dispatch(full);
  return own;
}

std::vector<float> pack_own_share(const OwnShareWeights& layers) {
  std::vector<float> values;
  const auto fill_vector = [&] {
    values.resize(static_cast<std::size_t>(ceil_div(static_cast<int>(values.size()), kVector)) * kVector);
  };
  for (const Layer& layer : layers) {
    for (int output = 0; output < layer.outputs; ++output) {
      for (int input = 0; input < layer.inputs; ++input) values.push_back(layer.at(output, input));
      fill_vector();
    }
    values.insert(values.end(), layer.bias.begin(), layer.bias.end());
    fill_vector();
  }
  return values;
}

}  // namespace becalm::filter
