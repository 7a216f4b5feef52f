#include "filter/merge/carried_images.h"

#include <fmt/format.h>

#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

std::vector<gpu::ImageId> carried_inputs(gpu::Chain& chain, std::size_t count, gpu::Extent extent,
                                         const std::string& name) {
  std::vector<gpu::ImageId> inputs;
  for (std::size_t i = 0; i < count; ++i) {
    inputs.push_back(chain.input(fmt::format("{}.{}", name, i), gpu::Format::f32x4, extent));
  }
  return inputs;
}

void upload_carried(gpu::Chain& chain, const std::vector<gpu::ImageId>& inputs,
                    const std::vector<Image>& images, const Rect& rect) {
  for (std::size_t i = 0; i < inputs.size(); ++i) upload(chain, inputs[i], view(images[i]), rect);
}

std::vector<std::span<const float>> download_carried(const gpu::Chain& chain,
                                                     const std::vector<gpu::ImageId>& images) {
  std::vector<std::span<const float>> pixels;
  pixels.reserve(images.size());
  for (const gpu::ImageId image : images) pixels.push_back(chain.download<float>(image));
  return pixels;
}

}  // namespace becalm::filter
