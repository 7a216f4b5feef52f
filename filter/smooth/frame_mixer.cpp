#include "filter/smooth/frame_mixer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "filter/for_rows.h"
#include "filter/input/noisy_inputs.h"
#include "filter/luminance.h"
#include "filter/merge/carried_images.h"
#include "filter/smooth/network.h"
#include "filter/smooth/own_share.h"
#include "filter/smooth/restore.h"
#include "filter/smooth/weights.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

namespace {

/// Mean squared relative difference of a frame from its estimate up to which it is nearly clean. The 16 of 54
/// held-out frames below it lose 2 % of accuracy at most; above, some lose 10 %.
constexpr double kNearlyClean = 0.02;

/// Squared difference, averaged over channels, over the squared brightness (shaders/lib/color.glsl); 1 at
/// most, so that no firefly makes a frame noisy.
double relative_square(std::span<const float> frame, std::span<const float> estimate, double exposure) {
  double square = 0.0;
  for (std::size_t c = 0; c < 3; ++c) square += std::pow(double(frame[c]) - estimate[c], 2) / 3.0;
  const double brightness = std::max(luminance(estimate), 0.0f) + 0.1 / exposure;
  return std::min(square / (brightness * brightness), 1.0);
}

bool is_nearly_clean(const NewFrame& frame, const Estimate& estimate) {
  const std::span<const float> noisy = frame.frame.image(Aov::beauty).data();
  const std::span<const float> color = estimate.color.data();
  const auto width = static_cast<std::size_t>(estimate.color.width());
  // Less than 0 for a frame whose mean is below the limit.
  const double excess = sum_of_rows<double>(estimate.color.height(), [&](int y) {
    double of_row = 0.0;
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      if (!frame.finite[i]) continue;
      of_row += relative_square(noisy.subspan(4 * i, 3), color.subspan(4 * i, 3), frame.exposure);
      of_row -= kNearlyClean;
    }
    return of_row;
  });
  return excess < 0.0;
}

}  // namespace

struct FrameMixer::Passes {
  Passes(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "mix"),
        noisy(chain, task, extent, NoisyUse::smooth),
        additive(carried_inputs(chain, task.additive, extent, "additive.cur")),
        color(chain.input("estimate.color", Format::f32x4, extent)),
        stats(chain.input("estimate.stats", Format::f32x2, extent)),
        carried(carried_inputs(chain, task.additive, extent, "estimate.additive")) {
    const int vectors = static_cast<int>(pack_own_share(embedded_own_share()).size()) / 4;
    weights = chain.table("weights.own_share", Format::f32x4, {vectors, 1});
    const OwnShare own = add_own_share(chain, extent, noisy, {color, stats, {}}, weights);
    mixed = {.color = add_restore(chain, extent, "mixed.color", noisy.color, color, own.share),
             .stats = own.stats,
             .additive = {}};
    chain.output(mixed.color);
    chain.output(mixed.stats);
    for (std::size_t i = 0; i < additive.size(); ++i) {
      mixed.additive.push_back(add_restore(chain, extent, fmt::format("mixed.additive.{}", i), additive[i],
                                           carried[i], own.share));
      chain.output(mixed.additive.back());
    }
  }

  gpu::Chain chain;
  NoisyInputs noisy;
  std::vector<ImageId> additive;
  ImageId color;  ///< of the estimate, as the next two
  ImageId stats;
  std::vector<ImageId> carried;
  ImageId weights;
  Smoothed mixed;
};

FrameMixer::FrameMixer(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task), chain_(device, task, memory_limit) {
  Passes& passes = chain_.passes();
  std::ranges::copy(pack_own_share(embedded_own_share()), passes.chain.upload<float>(passes.weights).begin());
}

FrameMixer::~FrameMixer() = default;

FilterMemory FrameMixer::memory() const {
  return chain_.memory();
}

void FrameMixer::mix(const NewFrame& frame, Estimate& estimate, FrameReport& report) {
  if (!is_nearly_clean(frame, estimate)) return;
  Estimate mixed(task_.full, task_.additive);
  FrameReport ignored;  // replaced variances are counted when the frame is merged
  const auto upload = [&](Passes& passes, const Tile& tile) {
    passes.noisy.upload(passes.chain, task_, frame, tile, ignored);
    upload_carried(passes.chain, passes.additive, frame.additive, tile.target);
    filter::upload(passes.chain, passes.color, view(std::as_const(estimate.color)), tile.target);
    filter::upload(passes.chain, passes.stats, view(std::as_const(estimate.stats)), tile.target);
    upload_carried(passes.chain, passes.carried, estimate.carried, tile.target);
  };
  const auto download = [&](const Passes& passes, const Tile& tile) {
    copy_core(passes.chain.download<float>(passes.mixed.color), tile, mixed.color);
    copy_core(passes.chain.download<float>(passes.mixed.stats), tile, mixed.stats);
    copy_core(download_carried(passes.chain, passes.mixed.additive), tile, mixed.carried);
  };
  chain_.run(report, upload, download);
  mixed.noise = std::move(estimate.noise);
  estimate = std::move(mixed);
}

}  // namespace becalm::filter
