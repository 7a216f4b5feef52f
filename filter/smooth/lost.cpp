#include "filter/smooth/lost.h"

#include "filter/merge/patch_sums.h"

namespace becalm::filter {

Lost add_lost(gpu::Chain& chain, gpu::Extent full, const std::string& name, const NoisyInputs& frame,
              gpu::ImageId color, gpu::ImageId smoothed, std::optional<gpu::ImageId> frames) {
  const gpu::ImageId pixels = chain.image(name, gpu::Format::f32x4, full);
  chain.pass("smooth/lost")
      .read("color", color)
      .read("variance", frame.variance)
      .read("frames", frames)
      .read("smoothed", smoothed)
      .read("exposure", frame.exposure)
      .write("lost", pixels)
      .specialize("of_one_frame", frames ? 1 : 0)
      .dispatch(full);
  return {pixels, add_patch_sums(chain, kLostRadius, full, pixels, name)};
}

}  // namespace becalm::filter
