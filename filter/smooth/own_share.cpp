#include "filter/smooth/own_share.h"

#include "filter/merge/patch_sums.h"

namespace becalm::filter {

using gpu::Format;
using gpu::ImageId;

namespace {

/// Radius of the patches over which differences and shares are averaged.
constexpr int kPatchRadius = 3;

}  // namespace

OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, ImageId color,
                       ImageId stats, ImageId expected) {
  const ImageId lost = chain.image("own.lost", Format::f32x4, full);
  chain.pass("smooth/lost")
      .read("color", frame.own_color)
      .read("variance", frame.variance)
      .read("frames", frame.frames)
      .read("smoothed", color)
      .read("exposure", frame.exposure)
      .write("lost", lost)
      .specialize("of_one_frame", 1)
      .dispatch(full);
  const ImageId lost_sums = add_patch_sums(chain, kPatchRadius, full, lost, "own.lost");
  const ImageId blur = chain.image("own.blur", Format::f32x4, full);
  chain.pass("smooth/blur")
      .read("lost", lost, gpu::reach(kPatchRadius, 0))
      .read("lost_sums", lost_sums)
      .read("frames", frame.frames)
      .read("smoothed", color)
      .read("expected", expected)
      .read("exposure", frame.exposure)
      .write("blur", blur)
      .specialize("radius", kPatchRadius)
      .dispatch(full);
  const ImageId blur_sums = add_patch_sums(chain, kPatchRadius, full, blur, "own.blur");
  const OwnShare own{.share = chain.image("own.share", Format::f32, full),
                     .stats = chain.image("own.stats", Format::f32x2, full)};
  chain.pass("smooth/own_share")
      .read("blur", blur, gpu::reach(kPatchRadius, 0))
      .read("blur_sums", blur_sums)
      .read("lost", lost)
      .read("variance", frame.variance)
      .read("frames", frame.frames)
      .read("stats", stats)
      .write("share", own.share)
      .write("mixed_stats", own.stats)
      .specialize("radius", kPatchRadius)
      .dispatch(full);
  return own;
}

}  // namespace becalm::filter
