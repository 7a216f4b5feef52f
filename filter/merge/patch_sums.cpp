#include "filter/merge/patch_sums.h"

namespace becalm::filter {

using gpu::Format;
using gpu::ImageId;

ImageId add_patch_sums(gpu::Chain& chain, int radius, gpu::Extent full, ImageId statistics,
                       const std::string& name) {
  const ImageId rows = chain.image(name + ".rows", Format::f32x4, full);
  const ImageId sums = chain.image(name + ".sums", Format::f32x4, full);
  const auto box = [&](ImageId in, ImageId out, bool along_y) {
    chain.pass("merge/box")
        .read("statistics", in, along_y ? gpu::reach(0, radius) : gpu::reach(radius, 0))
        .write("sums", out)
        .specialize("radius", radius)
        .specialize("along_y", along_y ? 1 : 0)
        .dispatch(full);
  };
  box(statistics, rows, false);
  box(rows, sums, true);
  return sums;
}

}  // namespace becalm::filter
