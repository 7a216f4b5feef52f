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

/// Mean squared relative difference of a frame from its estimate up to which it is clean, and from which it
/// is noisy. Mixed before the merge, none of the 16 held-out frames (of 54) below 0.02 had more than 2.5 %
/// more error, in any preset; above 0.025, one had 10 % more.
constexpr double kClean = 0.015;
constexpr double kNoisy = 0.025;

/// Squared difference, averaged over channels, over the squared brightness (shaders/lib/color.glsl); 1 at
/// most, so that no firefly makes a frame noisy.
double relative_square(std::span<const float> frame, std::span<const float> estimate, double exposure) {
  double square = 0.0;
  for (std::size_t c = 0; c < 3; ++c) square += std::pow(double(frame[c]) - estimate[c], 2) / 3.0;
  const double brightness = std::max(luminance(estimate), 0.0f) + 0.1 / exposure;
  return std::min(square / (brightness * brightness), 1.0);
}

bool is_black(std::span<const float> pixel) {
  return std::ranges::all_of(pixel, [](float value) { return value == 0.0f; });
}

/// Sum over the pixels of a row or of a frame.
struct Differences {
  Differences& operator+=(const Differences& other) {
    sum += other.sum;
    pixels += other.pixels;
    return *this;
  }

  double sum = 0.0;
  int pixels = 0;
};

/// By what the frame's share is multiplied: 1 if it is clean, 0 if it is noisy. In between it falls, so that
/// detail does not come and go from frame to frame.
float fade_of(const NewFrame& frame, const Estimate& estimate) {
  const std::span<const float> noisy = frame.frame.image(Aov::beauty).data();
  const std::span<const float> color = estimate.color.data();
  const auto width = static_cast<std::size_t>(estimate.color.width());
  const auto of_row = [&](int y) {
    Differences row;
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      // An empty background is neither clean nor noisy.
      if (!frame.finite[i] || (is_black(noisy.subspan(4 * i, 3)) && is_black(color.subspan(4 * i, 3))))
        continue;
      row += {relative_square(noisy.subspan(4 * i, 3), color.subspan(4 * i, 3), frame.exposure), 1};
    }
    return row;
  };
  const auto [sum, pixels] = sum_of_rows<Differences>(estimate.color.height(), of_row);
  if (pixels == 0) return 0.0f;
  return static_cast<float>(std::clamp((kNoisy - sum / pixels) / (kNoisy - kClean), 0.0, 1.0));
}

}  // namespace

struct FrameMixer::Passes {
  Passes(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "mix"),
        noisy(chain, task, extent, NoisyUse::smooth),
        additive(carried_inputs(chain, task.additive, extent, "additive.cur")),
        color(chain.input("estimate.color", Format::f32x4, extent)),
        stats(chain.input("estimate.stats", Format::f32x2, extent)),
        carried(carried_inputs(chain, task.additive, extent, "estimate.additive")),
        fade(chain.table("fade", Format::f32, {1, 1})) {
    const int vectors = static_cast<int>(pack_own_share(embedded_own_share()).size()) / 4;
    weights = chain.table("weights.own_share", Format::f32x4, {vectors, 1});
    const OwnShare own = add_own_share(chain, extent, noisy, {color, stats, {}, fade}, weights);
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
  ImageId fade;
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
  const float fade = fade_of(frame, estimate);
  if (fade == 0.0f) return;
  Estimate mixed(task_.full, task_.additive);
  FrameReport ignored;  // replaced variances are counted when the frame is merged
  const auto upload = [&](Passes& passes, const Tile& tile) {
    passes.noisy.upload(passes.chain, task_, frame, tile, ignored);
    upload_carried(passes.chain, passes.additive, frame.additive, tile.target);
    filter::upload(passes.chain, passes.color, view(std::as_const(estimate.color)), tile.target);
    filter::upload(passes.chain, passes.stats, view(std::as_const(estimate.stats)), tile.target);
    upload_carried(passes.chain, passes.carried, estimate.carried, tile.target);
    passes.chain.upload<float>(passes.fade)[0] = fade;
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
