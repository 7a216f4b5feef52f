#include "filter/merge/patch_sums.h"

#include "filter/ceil_div.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

namespace {

/// Pixels along the direction of a sum that one invocation computes, which share reads: half the time on a
/// software device. Hardware needs many invocations.
int sum_strip(const gpu::DeviceInfo& device) {
  return device.is_processor ? 4 : 1;
}

}  // namespace

PatchSums add_patch_sums(gpu::Chain& chain, int radius, gpu::Extent full, ImageId statistics,
                         const std::string& name) {
  if (radius == 1) return {.of_other_rows = std::nullopt, .reach = gpu::reach(1)};
  const ImageId rows = chain.image(name + ".rows", Format::f32x4, full);
  const ImageId sums = chain.image(name + ".sums", Format::f32x4, full);
  const int strip = sum_strip(chain.device());
  const auto box = [&](ImageId in, ImageId out, bool along_y) {
    chain.pass("merge/box")
        .read("statistics", in, along_y ? gpu::reach(0, radius) : gpu::reach(radius, 0))
        .write("sums", out)
        .specialize("radius", radius)
        .specialize("along_y", along_y ? 1 : 0)
        .specialize("strip", strip)
        .dispatch(along_y ? Extent{full.width, ceil_div(full.height, strip)}
                          : Extent{ceil_div(full.width, strip), full.height});
  };
  box(statistics, rows, false);
  box(rows, sums, true);
  return {.of_other_rows = sums, .reach = gpu::reach(radius, 0)};
}

}  // namespace becalm::filter
