#include "filter/smooth/own_share.h"

#include "filter/merge/patch_sums.h"
#include "filter/smooth/lost.h"

namespace becalm::filter {

using gpu::Format;
using gpu::ImageId;

OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, ImageId color,
                       ImageId stats, ImageId expected) {
  const Lost lost = add_lost(chain, full, "own.lost", frame, frame.own_color, color, frame.frames);
  const ImageId blur = chain.image("own.blur", Format::f32x4, full);
  chain.pass("smooth/blur")
      .read("lost", lost.pixels, gpu::reach(kLostRadius, 0))
      .read("lost_sums", lost.sums)
      .read("frames", frame.frames)
      .read("smoothed", color)
      .read("expected", expected)
      .read("exposure", frame.exposure)
      .write("blur", blur)
      .specialize("radius", kLostRadius)
      .dispatch(full);
  const ImageId blur_sums = add_patch_sums(chain, kLostRadius, full, blur, "own.blur");
  const OwnShare own{.share = chain.image("own.share", Format::f32, full),
                     .stats = chain.image("own.stats", Format::f32x2, full)};
  chain.pass("smooth/own_share")
      .read("blur", blur, gpu::reach(kLostRadius, 0))
      .read("blur_sums", blur_sums)
      .read("lost", lost.pixels)
      .read("variance", frame.variance)
      .read("frames", frame.frames)
      .read("stats", stats)
      .write("share", own.share)
      .write("mixed_stats", own.stats)
      .specialize("radius", kLostRadius)
      .dispatch(full);
  return own;
}

}  // namespace becalm::filter
