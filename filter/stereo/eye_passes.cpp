#include "filter/stereo/eye_passes.h"

#include <fmt/format.h>

#include "filter/input/host_images.h"
#include "filter/merge/patch_sums.h"
#include "filter/merge/statistics.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

EyePasses::EyePasses(gpu::Device& device, const FilterTask& task, int limit_px, Extent target, Extent source)
    : chain(device, "eyes"),
      exposure(chain.table("exposure", Format::f32, {1, 1})),
      extent(target),
      window{source, chain.table("target_origin", Format::f32x2, {1, 1})},
      own(chain, task, target, "own"),
      other(chain, task, source, "other"),
      offset(chain.input("offset", Format::f32x2, target)) {
  if (contains(task.used, Aov::depth)) {
    expected_depth = chain.input("expected_depth", Format::f32, target);
    other_depth = chain.input("other.depth", Format::f32, source);
  }
  WarpInputs inputs{
      .color = other.color, .stats = other.stats, .window = window, .offset_limit_px = limit_px};
  const std::size_t radiance = task.additive + FilterTask::kNoisyRadiance;
  for (std::size_t i = 0; i < other.carried.size(); ++i) {
    // The additive AOVs, then the noisy layers: radiance, and two of features.
    inputs.carried.push_back({other.carried[i], i < task.additive ? Carried::additive
                                                : i == radiance   ? Carried::radiance
                                                                  : Carried::features});
  }
  add_blend(task, add_warp_passes(chain, task.settings, target, inputs, add_depth_check(limit_px)));
}

void EyePasses::upload_other(const EyeFrame& eye, const Rect& rect) {
  other.upload(chain, eye.estimate, rect);
  if (other_depth) upload(chain, *other_depth, view(eye.frame.frame.image(Aov::depth)), rect);
}

ImageId EyePasses::add_depth_check(int limit_px) {
  if (!other_depth) return offset;
  const ImageId checked = chain.image("offset.checked", Format::f32x2, extent);
  chain.pass("stereo/check_depth")
      .read("offset_given", offset)
      .read("expected_depth", *expected_depth)
      .read("other_depth", other_depth, gpu::gather(limit_px + 1))
      .read("target_origin", window.target_origin)
      .write("offset", checked)
      .dispatch(extent);
  return checked;
}

void EyePasses::add_blend(const FilterTask& task, const WarpedHistory& warped) {
  const Extent target = extent;
  const int radius = task.settings.patch_radius;
  FrameToCompare estimate{
      .color = own.color, .variance = own.stats, .exposure = exposure, .smoothed = task.smooths()};
  if (task.smooths_merged()) {
    estimate.noisy = {.image = own.carried[task.additive + FilterTask::kNoisyRadiance], .channel = 3};
  }
  const auto [difference, noise] = add_statistics(chain, target, estimate, warped);
  const PatchSums difference_sums = add_patch_sums(chain, radius, target, difference, "difference");
  const PatchSums noise_sums = add_patch_sums(chain, radius, target, noise, "noise");
  color = chain.image("combined.color", Format::f32x4, target);
  stats = chain.image("combined.stats", Format::f32x2, target);
  weight = chain.image("weight", Format::f32, target);
  chain.pass("stereo/blend")
      .read("own_color", own.color)
      .read("own_stats", own.stats)
      .read("warped_color", warped.color)
      .read("warped_stats", warped.stats)
      .read("difference", difference, difference_sums.reach)
      .read("noise", noise, noise_sums.reach)
      .read("difference_sums", difference_sums.sums)
      .read("noise_sums", noise_sums.sums)
      .read("exposure", exposure)
      .write("color", color)
      .write("stats", stats)
      .write("weight_other", weight)
      .specialize("radius", radius)
      .specialize("smoothed", estimate.smoothed ? 1 : 0)
      .dispatch(target);
  for (std::size_t i = 0; i < own.carried.size(); ++i) {
    carried.push_back(chain.image(fmt::format("combined.carried.{}", i), Format::f32x4, target));
    chain.pass("merge/carried_combine")
        .read("forward_color", own.carried[i])
        .read("backward_color", warped.carried[i])
        .read("weight", weight)
        .write("combined", carried.back())
        .dispatch(target);
  }
  chain.output(color);
  chain.output(stats);
  chain.output(weight);
  for (const ImageId image : carried) chain.output(image);
}

}  // namespace becalm::filter
