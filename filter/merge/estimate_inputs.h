#pragma once

#include <string>
#include <vector>

#include "filter/estimate.h"
#include "filter/gpu/chain.h"
#include "filter/merge/carried_images.h"
#include "filter/task.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

/// The inputs of a chain for an estimate or a tile of it, with all that it carries.
struct EstimateInputs {
  EstimateInputs(gpu::Chain& chain, const FilterTask& task, gpu::Extent extent, const std::string& name)
      : color(chain.input(name + ".color", gpu::Format::f32x4, extent)),
        stats(chain.input(name + ".stats", gpu::Format::f32x2, extent)),
        carried(carried_inputs(chain, task.carried(), extent, name + ".carried")) {}

  void upload(gpu::Chain& chain, const Estimate& estimate, const Rect& rect) const {
    filter::upload(chain, color, view(estimate.color), rect);
    filter::upload(chain, stats, view(estimate.stats), rect);
    upload_carried(chain, carried, estimate.carried, rect);
  }

  gpu::ImageId color;
  gpu::ImageId stats;
  std::vector<gpu::ImageId> carried;
};

}  // namespace becalm::filter
