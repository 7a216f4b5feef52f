#include "filter/antialias/sharpener.h"

#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Format;

SharpenPasses::SharpenPasses(gpu::Device& device, const FilterTask&, gpu::Extent extent)
    : chain(device, "sharpen"),
      color(chain.input("color", Format::f32x4, extent)),
      amount(chain.table("amount", Format::f32, {1, 1})),
      sharpened(chain.image("sharpened", Format::f32x4, extent)) {
  chain.pass("antialias/sharpen")
      .read("color", color, gpu::reach(1))
      .read("amount", amount)
      .write("sharpened", sharpened)
      .dispatch(extent);
  chain.output(sharpened);
}

Image Sharpener::run(const Image& color, FrameReport& report) {
  Image result(color.width(), color.height(), 4);
  chain_.run(
      report,
      [&](SharpenPasses& passes, const Tile& tile) {
        upload(passes.chain, passes.color, view(color), tile.target);
        passes.chain.upload<float>(passes.amount)[0] = amount_;
      },
      [&](const SharpenPasses& passes, const Tile& tile) {
        copy_core(passes.chain.download<float>(passes.sharpened), tile, result);
      });
  return result;
}

}  // namespace becalm::filter
