#include "filter/merged_images.h"

#include "filter/additive.h"
#include "filter/pyramid.h"

namespace becalm::filter {

std::vector<CarriedInput> carried_inputs(gpu::Chain& chain, const FilterTask& task, gpu::Extent extent,
                                         const NoisyInputs& noisy, const std::vector<gpu::ImageId>& additive,
                                         const std::vector<gpu::History>& history) {
  std::vector<CarriedInput> inputs;
  for (std::size_t i = 0; i < additive.size(); ++i) inputs.push_back({additive[i], history[i]});
  if (!task.smooths_merged()) return inputs;
  const std::span<const gpu::History> rest = std::span(history).subspan(additive.size());
  for (const CarriedInput& layer : add_noisy_layers(chain, extent, noisy, rest)) inputs.push_back(layer);
  return inputs;
}

void add_outputs(gpu::Chain& chain, const FilterTask& task, const MergedImages& images) {
  chain.output(images.color);
  chain.output(images.stats);
  for (const gpu::ImageId image : images.additive) chain.output(image);
  chain.output(images.outputs.decision);
  if (task.settings.directions == Directions::both) {
    chain.output(images.outputs.warped_color);
    chain.output(images.outputs.warped_stats);
    for (const gpu::ImageId image : images.outputs.warped_additive) chain.output(image);
  }
  if (contains(task.diagnostics, Aov::flow)) chain.output(images.offset);
  if (contains(task.diagnostics, Aov::residual)) chain.output(images.residual);
}

MergedTile download(const gpu::Chain& chain, const FilterTask& task, const MergedImages& images) {
  MergedTile tile{.color = chain.download<float>(images.color),
                  .stats = chain.download<float>(images.stats),
                  .warped_color = {},
                  .warped_stats = {},
                  .additive = download_additive(chain, images.additive),
                  .warped_additive = {},
                  .decision = chain.download<float>(images.outputs.decision),
                  .offset = {},
                  .residual = {},
                  .residual_px = level_px(task.settings, 0)};
  if (task.settings.directions == Directions::both) {
    tile.warped_color = chain.download<float>(images.outputs.warped_color);
    tile.warped_stats = chain.download<float>(images.outputs.warped_stats);
    tile.warped_additive = download_additive(chain, images.outputs.warped_additive);
  }
  if (contains(task.diagnostics, Aov::flow)) tile.offset = chain.download<float>(images.offset);
  if (contains(task.diagnostics, Aov::residual)) tile.residual = chain.download<float>(images.residual);
  return tile;
}

}  // namespace becalm::filter
