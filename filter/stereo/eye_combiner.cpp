#include "filter/stereo/eye_combiner.h"

#include "filter/merge/carried_images.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

EyeCombiner::EyeCombiner(gpu::Device& device, const FilterTask& task, int limit_px,
                         std::uint64_t memory_limit)
    : task_(task), chain_(task.full, memory_limit, [&](gpu::Extent target, gpu::Extent source) {
        return std::make_unique<EyePasses>(device, task, limit_px, target, source);
      }) {}

Estimate EyeCombiner::run(const EyeFrame& own, const EyeFrame& other, const Correspondence& where,
                          Image& weight, FrameReport& report) {
  Estimate result(task_.full, task_.carried());
  const auto upload_tile = [&](EyePasses& passes, const Tile& tile) {
    gpu::Chain& chain = passes.chain;
    chain.upload<float>(passes.exposure)[0] = own.frame.exposure;
    upload_origin(chain, passes.window.target_origin, tile.target, tile.source);
    passes.own.upload(chain, own.estimate, tile.target);
    passes.upload_other(other, tile.source);
    upload(chain, passes.offset, view(where.offset), tile.target);
    if (passes.expected_depth) upload(chain, *passes.expected_depth, view(where.depth), tile.target);
  };
  const auto download_tile = [&](const EyePasses& passes, const Tile& tile) {
    const gpu::Chain& chain = passes.chain;
    copy_core(chain.download<float>(passes.color), tile, result.color);
    copy_core(chain.download<float>(passes.stats), tile, result.stats);
    copy_core(download_carried(chain, passes.carried), tile, result.carried);
    copy_core(chain.download<float>(passes.weight), tile, weight);
  };
  chain_.run(report, upload_tile, download_tile);
  return result;
}

}  // namespace becalm::filter
