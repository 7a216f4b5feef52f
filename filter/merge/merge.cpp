#include "filter/merge/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "filter/input/noisy_inputs.h"
#include "filter/merge/patch_sums.h"
#include "filter/merge/statistics.h"
#include "shaders/shared/limits.h"
#include "shaders/shared/merge_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

/// Footprint of a read of the history at the offsets, by either filter.
gpu::Footprint gather_history(const WarpInputs& history) {
  constexpr int taps = 2;  // of the sharp filter, on either side of the position
  return gpu::gather(history.offset_limit_px + taps);
}

/// The coefficients of the spline through the history's pixels.
ImageId add_spline_passes(Chain& chain, Extent extent, const WarpInputs& history) {
  const ImageId rows = chain.image("history.spline.rows", Format::f32x4, extent);
  const ImageId both = chain.image("history.spline", Format::f32x4, extent);
  chain.pass("merge/spline_coefficients")
      .read("image", history.color, gpu::reach(kSplineReach, 0))
      .write("coefficients", rows)
      .specialize("along_y", 0)
      .dispatch(extent);
  chain.pass("merge/spline_coefficients")
      .read("image", rows, gpu::reach(0, kSplineReach))
      .write("coefficients", both)
      .specialize("along_y", 1)
      .dispatch(extent);
  return both;
}

ImageId add_variance_gain(Chain& chain, const Settings& settings, Extent full, const MergeInputs& inputs,
                          const WarpedHistory& warped) {
  FrameToCompare frame{.color = inputs.color,
                       .variance = inputs.variance,
                       .exposure = inputs.noisy.exposure,
                       .smoothed = settings.smooth != Smooth::none};
  if (settings.smooth == Smooth::merged) frame.noisy = {.image = inputs.noisy.variance};
  const auto [difference, noise] = add_statistics(chain, full, frame, warped);
  const PatchSums difference_sums =
      add_patch_sums(chain, settings.patch_radius, full, difference, "difference");
  const PatchSums noise_sums = add_patch_sums(chain, settings.patch_radius, full, noise, "noise");
  const ImageId decision = chain.image("decision", Format::f32x4, full);
  chain.pass("merge/variance_gain")
      .read("color", inputs.color)
      .read("variance", inputs.variance)
      .read("warped_color", warped.color)
      .read("warped_stats", warped.stats)
      .read("exposure", inputs.noisy.exposure)
      .read("difference", difference, difference_sums.reach)
      .read("noise", noise, noise_sums.reach)
      .read("difference_sums", difference_sums.sums)
      .read("noise_sums", noise_sums.sums)
      .write("merged_color", inputs.history_color.next)
      .write("merged_stats", inputs.history_stats.next)
      .write("decision", decision)
      .specialize("radius", settings.patch_radius)
      .specialize("smoothed", frame.smoothed ? 1 : 0)
      .dispatch(full);
  return decision;
}

ImageId add_mask_gain(Chain& chain, const Settings& settings, Extent full, const MergeInputs& inputs,
                      const WarpedHistory& warped, const Alignment& alignment) {
  const ImageId decision = chain.image("decision", Format::f32x4, full);
  chain.pass("merge/mask_gain")
      .read("color", inputs.color)
      .read("variance", inputs.variance)
      .read("warped_color", warped.color)
      .read("warped_stats", warped.stats)
      .read("residual", alignment.residual, gpu::bilinear(settings.match_downsample))
      .write("merged_color", inputs.history_color.next)
      .write("merged_stats", inputs.history_stats.next)
      .write("decision", decision)
      .constants(params::MaskGainParams{.residual_scale = static_cast<float>(level_px(settings, 0))})
      .dispatch(full);
  return decision;
}

/// Radius of the patches that distinguish noise from detail.
constexpr int kNoisePatchRadius = 3;

/// The noisy layer, its variance limited to what differs from the history.
ImageId add_known_noise(Chain& chain, Extent full, ImageId noisy, ImageId warped, ImageId warped_stats,
                        const NoisyInputs& frame) {
  const ImageId statistics = chain.image("noise.repeated", Format::f32x4, full);
  chain.pass("merge/repeated_noise")
      .read("noisy", noisy)
      .read("warped_noisy", warped)
      .read("warped_stats", warped_stats)
      .read("exposure", frame.exposure)
      .read("variance", frame.variance)
      .write("statistics", statistics)
      .dispatch(full);
  const ImageId sums = add_box_sums(chain, kNoisePatchRadius, full, statistics, "noise.repeated");
  const ImageId known = chain.image("noisy.known", Format::f32x4, full);
  chain.pass("merge/known_noise")
      .read("noisy", noisy)
      .read("statistics", statistics)
      .read("statistics_sums", sums)
      .write("known", known)
      .dispatch(full);
  return known;
}

/// A carried image warped to the target, and the share of the sharp filter that it was read with.
struct CarriedRead {
  ImageId warped;
  std::optional<ImageId> share;  ///< its own, if others are read with it
};

/// Warps carried image `i` of the history. Additive AOVs are read with the given share, other images with a
/// share of their own that keeps them within the range of the nearest pixels and, if `share_is_read`, is
/// written.
CarriedRead add_carried_read(Chain& chain, const Settings& settings, Extent full, const SourceWindow& window,
                             ImageId offset, ImageId holes, const WarpInputs& history, std::size_t i,
                             std::optional<ImageId> share, bool share_is_read) {
  const CarriedImage& carried = history.carried[i];
  assert(settings.resample != Resample::spline && "only the beauty has spline coefficients");
  const bool own_share = carried.kind != Carried::additive;
  CarriedRead made{.warped = chain.image(fmt::format("warped.carried.{}", i), Format::f32x4, full),
                   .share = {}};
  if (own_share) share.reset();
  if (share_is_read) made.share = chain.image(fmt::format("warped.share.{}", i), Format::f32, full);
  chain.pass("merge/carried_warp")
      .read("offset", offset)
      .read("history_color", carried.image, gather_history(history))
      .read("holes", holes)
      .read("target_origin", window.target_origin)
      .read("share", share)
      .write("warped", made.warped)
      .write("own_share", made.share)
      .specialize("resample", static_cast<int>(settings.resample))
      .specialize("in_range", own_share ? 1 : 0)
      .specialize("writes_share", made.share ? 1 : 0)
      .dispatch(full);
  return made;
}

}  // namespace

WarpedHistory add_warp_passes(Chain& chain, const Settings& settings, Extent full, const WarpInputs& history,
                              ImageId offset) {
  WarpedHistory warped{chain.image("warped.color", Format::f32x4, full),
                       chain.image("warped.stats", Format::f32x2, full)};
  const SourceWindow window = history.window ? *history.window : add_same_window(chain, full, "origin.merge");
  std::optional<ImageId> share;
  std::optional<ImageId> holes;
  if (!history.carried.empty()) {
    share = chain.image("warped.share", Format::f32, full);
    holes = chain.image("warped.holes", Format::f32, full);
  }
  const ImageId sharp =
      settings.resample == Resample::spline ? add_spline_passes(chain, window.full, history) : history.color;
  chain.pass("merge/warp_history")
      .read("offset", offset)
      .read("history_sharp", sharp, gather_history(history))
      .read("history_color", history.color, gather_history(history))
      .read("history_stats", history.stats, gather_history(history))
      .read("target_origin", window.target_origin)
      .write("warped_color", warped.color)
      .write("warped_stats", warped.stats)
      .write("share", share)
      .write("holes", holes)
      .specialize("resample", static_cast<int>(settings.resample))
      .specialize("carries", share ? 1 : 0)
      .dispatch(full);
  // Additive AOVs add up to the noisy radiance if it is carried, else to the colour; they use its share.
  const auto noisy = std::ranges::find(history.carried, Carried::radiance, &CarriedImage::kind);
  warped.carried.resize(history.carried.size());
  std::optional<ImageId> share_of_light = share;
  const auto read = [&](std::size_t i, bool share_is_read) {
    const CarriedRead made = add_carried_read(chain, settings, full, window, offset, *holes, history, i,
                                              share_of_light, share_is_read);
    warped.carried[i] = made.warped;
    return made.share;
  };
  const auto first = static_cast<std::size_t>(noisy - history.carried.begin());
  const bool has_additive =
      std::ranges::find(history.carried, Carried::additive, &CarriedImage::kind) != history.carried.end();
  if (first < history.carried.size()) share_of_light = read(first, has_additive);
  for (std::size_t i = 0; i < history.carried.size(); ++i) {
    if (i != first) read(i, false);
  }
  return warped;
}

std::vector<CarriedInput> add_noisy_layers(Chain& chain, Extent full, const NoisyInputs& noisy,
                                           std::span<const gpu::History> history) {
  const ImageId carried = chain.image("noisy.cur", Format::f32x4, full);
  chain.pass("merge/carry")
      .read("color", noisy.color)
      .read("variance", noisy.variance)
      .write("carried", carried)
      .dispatch(full);
  std::vector<CarriedInput> layers(FilterTask::kNoisyLayers);
  const auto set = [&](std::size_t layer, ImageId color, Carried kind) {
    layers[layer] = {.color = color, .history = history[layer], .kind = kind};
  };
  set(FilterTask::kNoisyRadiance, carried, Carried::radiance);
  set(FilterTask::kNoisyAlbedoDepth, noisy.features->albedo_depth, Carried::features);
  set(FilterTask::kNoisyNormal, noisy.features->normal, Carried::features);
  return layers;
}

MergeOutputs add_merge_passes(Chain& chain, const Settings& settings, Extent full, const MergeInputs& inputs,
                              const Alignment& alignment) {
  std::vector<CarriedImage> carried_history;
  for (const CarriedInput& input : inputs.carried) {
    carried_history.push_back({input.history.previous, input.kind});
  }
  WarpedHistory warped = add_warp_passes(chain, settings, full,
                                         {.color = inputs.history_color.previous,
                                          .stats = inputs.history_stats.previous,
                                          .window = inputs.history_window,
                                          .carried = std::move(carried_history),
                                          .offset_limit_px = alignment.limit_px},
                                         alignment.offset);
  const ImageId decision = settings.merge == MergeMode::variance
                               ? add_variance_gain(chain, settings, full, inputs, warped)
                               : add_mask_gain(chain, settings, full, inputs, warped, alignment);
  for (std::size_t i = 0; i < inputs.carried.size(); ++i) {
    const ImageId layer = inputs.carried[i].color;
    const ImageId color =
        inputs.carried[i].kind == Carried::radiance
            ? add_known_noise(chain, full, layer, warped.carried[i], warped.stats, inputs.noisy)
            : layer;
    chain.pass("merge/carried_blend")
        .read("color", color)
        .read("warped_color", warped.carried[i])
        .read("warped_stats", warped.stats)
        .read("decision", decision)
        .write("merged", inputs.carried[i].history.next)
        .dispatch(full);
  }
  return {warped.color, warped.stats, std::move(warped.carried), decision};
}

}  // namespace becalm::filter
