#include "filter/smooth/shares.h"

#include "filter/ceil_div.h"
#include "filter/merge/patch_sums.h"

namespace becalm::filter {
namespace {

/// Radius of the patches over which differences are averaged.
constexpr int kRadius = 3;
constexpr int kVector = 4;

}  // namespace

Shares add_shares(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, gpu::ImageId merged,
                  gpu::ImageId error, gpu::ImageId weights) {
  using gpu::Format;
  const gpu::ImageId differences = chain.image("shares.differences", Format::f32x4, full);
  const gpu::ImageId errors = chain.image("shares.errors", Format::f32x4, full);
  chain.pass("smooth/differences")
      .read("frame", frame.own_color)
      .read("variance", frame.variance)
      .read("merged", merged)
      .read("merged_error", error)
      .read("alone", frame.alone->color)
      .read("alone_error", frame.alone->stats)
      .read("exposure", frame.exposure)
      .write("differences", differences)
      .write("errors", errors)
      .dispatch(full);
  const gpu::ImageId difference_sums =
      add_patch_sums(chain, kRadius, full, differences, "shares.differences");
  const gpu::ImageId error_sums = add_patch_sums(chain, kRadius, full, errors, "shares.errors");
  const Shares shares{.of_frame = chain.image("shares.frame", Format::f32, full),
                      .of_alone = chain.image("shares.alone", Format::f32, full),
                      .stats = chain.image("shares.stats", Format::f32x2, full)};
  chain.pass("smooth/shares")
      .read("differences", differences, gpu::reach(kRadius, 0))
      .read("errors", errors, gpu::reach(kRadius, 0))
      .read("difference_sums", difference_sums)
      .read("error_sums", error_sums)
      .read("merged_error", error)
      .read("alone_error", frame.alone->stats)
      .read("merged", merged)
      .read("exposure", frame.exposure)
      .read("weights", weights)
      .write("frame_share", shares.of_frame)
      .write("alone_share", shares.of_alone)
      .write("stats", shares.stats)
      .specialize("radius", kRadius)
      .dispatch(full);
  return shares;
}

std::vector<float> pack_shares(const ShareWeights& layers) {
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
