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

ImageId add_box_sums(gpu::Chain& chain, int radius, Extent full, ImageId statistics,
                     const std::string& name) {
  const auto image = [&](const char* what) { return chain.image(name + what, Format::f32x4, full); };
  const ImageId rows = image(".rows");
  const ImageId beside = image(".beside");
  const ImageId sums = image(".sums");
  const int strip = sum_strip(chain.device());
  chain.pass("merge/box")
      .read("statistics", statistics, gpu::reach(radius, 0))
      .read("beside", std::nullopt)
      .write("sums", rows)
      .write("new_beside", beside)
      .specialize("radius", radius)
      .specialize("along_y", 0)
      .specialize("strip", strip)
      .dispatch({ceil_div(full.width, strip), full.height});
  chain.pass("merge/box")
      .read("statistics", rows, gpu::reach(0, radius))
      .read("beside", beside)
      .write("sums", sums)
      .write("new_beside", std::nullopt)
      .specialize("radius", radius)
      .specialize("along_y", 1)
      .specialize("strip", strip)
      .dispatch({full.width, ceil_div(full.height, strip)});
  return sums;
}

PatchSums add_patch_sums(gpu::Chain& chain, int radius, Extent full, ImageId statistics,
                         const std::string& name) {
  if (radius == 1) return {.sums = std::nullopt, .reach = gpu::reach(1)};
  return {.sums = add_box_sums(chain, radius, full, statistics, name), .reach = {}};
}

}  // namespace becalm::filter
