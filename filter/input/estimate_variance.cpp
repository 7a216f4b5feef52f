#include "filter/input/estimate_variance.h"

namespace becalm::filter {
namespace {

gpu::ImageId estimate_image(gpu::Chain& chain, gpu::Extent full) {
  return chain.image("variance.estimated", gpu::Format::f32x2, full);
}

}  // namespace

gpu::ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color,
                                   gpu::ImageId valid, const SurfaceImages& features) {
  const gpu::ImageId variance = estimate_image(chain, full);
  chain.pass("merge/estimate_variance")
      .read("color", color, gpu::reach(1))
      .read("valid", valid, gpu::reach(1))
      .read("albedo_depth", features.albedo_depth, gpu::reach(1))
      .read("normal", features.normal, gpu::reach(1))
      .write("variance", variance)
      .dispatch(full);
  return variance;
}

gpu::ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color,
                                   gpu::ImageId valid) {
  const gpu::ImageId variance = estimate_image(chain, full);
  chain.pass("merge/second_difference")
      .read("color", color, gpu::reach(2))  // pixels at the border read the three nearest of a row
      .read("valid", valid)
      .write("variance", variance)
      .dispatch(full);
  return variance;
}

}  // namespace becalm::filter
