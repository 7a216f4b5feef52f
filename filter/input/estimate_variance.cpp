#include "filter/input/estimate_variance.h"

#include "filter/merge/patch_sums.h"

namespace becalm::filter {
namespace {

using gpu::Format;
using gpu::ImageId;

/// Radius of the patches that tell noise from detail.
constexpr int kPatchRadius = 3;
/// Of the differences that they sum.
constexpr int kDifferenceReach = 2;

/// What differs from pixel to pixel, more than features explain.
ImageId add_estimate(gpu::Chain& chain, gpu::Extent full, const FrameWithoutVariance& frame) {
  const ImageId estimate = chain.image("variance.differing", Format::f32x2, full);
  if (frame.features) {
    chain.pass("merge/estimate_variance")
        .read("color", frame.color, gpu::reach(1))
        .read("valid", frame.valid, gpu::reach(1))
        .read("albedo_depth", frame.features->albedo_depth, gpu::reach(1))
        .read("normal", frame.features->normal, gpu::reach(1))
        .write("variance", estimate)
        .dispatch(full);
  } else {
    chain.pass("merge/second_difference")
        .read("color", frame.color, gpu::reach(2))  // pixels at the border read the three nearest of a row
        .read("valid", frame.valid)
        .write("variance", estimate)
        .dispatch(full);
  }
  return estimate;
}

}  // namespace

ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, const FrameWithoutVariance& frame) {
  const ImageId estimate = add_estimate(chain, full, frame);
  const ImageId scales = chain.image("noise.scales", Format::f32x4, full);
  std::optional<ImageId> albedo_depth;
  if (frame.features) albedo_depth = frame.features->albedo_depth;
  chain.pass("merge/noise_scales")
      .read("color", frame.color, gpu::reach(kDifferenceReach))
      .read("valid", frame.valid)
      .read("albedo_depth", albedo_depth, gpu::reach(kDifferenceReach))
      .read("exposure", frame.exposure)
      .write("scales", scales)
      .specialize("has_albedo", albedo_depth ? 1 : 0)
      .dispatch(full);
  const ImageId sums = add_box_sums(chain, kPatchRadius, full, scales, "noise.scales");
  const ImageId variance = chain.image("variance.estimated", Format::f32x2, full);
  chain.pass("merge/noise_share")
      .read("estimate", estimate)
      .read("scales_sums", sums)
      .read("noise_ratio", frame.noise_ratio)
      .write("variance", variance)
      .specialize("has_albedo", albedo_depth ? 1 : 0)
      .dispatch(full);
  return variance;
}

}  // namespace becalm::filter
