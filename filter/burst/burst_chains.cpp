#include "filter/burst/burst_chains.h"

#include <algorithm>
#include <string>

#include "filter/align/align.h"
#include "filter/ceil_div.h"
#include "shaders/shared/burst_params.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

namespace {

Extent in_blocks(const BurstTask& task, Extent extent) {
  return {ceil_div(extent.width, task.block), ceil_div(extent.height, task.block)};
}

ImageId colors_table(gpu::Chain& chain, const BurstTask& task) {
  return chain.table("colors", Format::f32, {task.cfa.period, task.cfa.period});
}

ImageId levels_table(gpu::Chain& chain) {
  return chain.table("levels", Format::f32, {static_cast<int>(Levels{}.size()), 1});
}

params::ReduceParams shares(const CfaPattern& cfa) {
  const int cells = cfa.period * cfa.period;
  const auto share = [&](int color) {
    const auto end = cfa.colors.begin() + cells;
    return static_cast<float>(std::count(cfa.colors.begin(), end, color)) / static_cast<float>(cells);
  };
  return {.red_share = share(0), .green_share = share(1), .blue_share = share(2)};
}

}  // namespace

BurstAlignPasses::BurstAlignPasses(gpu::Device& device, const BurstTask& task) : chain(device, "align") {
  reference = chain.input("reference", Format::f32, task.full);
  frame = chain.input("frame", Format::f32, task.full);
  colors = colors_table(chain, task);
  levels = levels_table(chain);
  const Extent blocks = in_blocks(task, task.full);
  const auto features = [&](const std::string& name, ImageId mosaic) {
    const ImageId feature = chain.image("features." + name, Format::f32, blocks);
    chain.pass("burst/reduce")
        .read("mosaic", mosaic, gpu::block(task.block))
        .read("colors", colors)
        .read("levels", levels)
        .write("feature", feature)
        .specialize("block", task.block)
        .specialize("period", task.cfa.period)
        .constants(shares(task.cfa))
        .dispatch(blocks);
    return Features{feature, 1};
  };
  const Features of_target = features("target", reference);
  const Features of_source = features("source", frame);
  target = of_target.image;
  source = of_source.image;
  chain.output(target, task.block);
  chain.output(source, task.block);
  const Alignment found = add_align_passes(chain, task.aligner, blocks, of_target, of_source);
  offset = found.offset;
  limit_px = found.limit_px * task.block;
  chain.output(offset, task.block);
}

BurstChoosePasses::BurstChoosePasses(gpu::Device& device, const BurstTask& task) : chain(device, "choose") {
  const Extent blocks = in_blocks(task, task.full);
  target = chain.input("features.target", Format::f32, blocks);
  source = chain.input("features.source", Format::f32, blocks);
  found = chain.input("offset.found", Format::f32x2, blocks);
  whole = chain.input("offset.whole", Format::f32x2, blocks);
  const ImageId differences = chain.image("differences", Format::f32x2, blocks);
  const ImageId sums = chain.image("differences.columns", Format::f32x2, blocks);
  offset = chain.image("offset", Format::f32x2, blocks);
  chain.pass("burst/differences_at")
      .read("target", target)
      .read("source", source, gpu::anywhere())
      .read("found", found)
      .read("whole", whole)
      .write("difference", differences)
      .dispatch(blocks);
  chain.pass("burst/sum_match_column")
      .read("difference", differences, gpu::reach(0, kChoicePatchRadius))
      .write("sums", sums)
      .specialize("radius", kChoicePatchRadius)
      .dispatch(blocks);
  chain.pass("burst/choose_offset")
      .read("sums", sums, gpu::reach(kChoicePatchRadius, 0))
      .read("found", found)
      .read("whole", whole)
      .write("offset", offset)
      .specialize("radius", kChoicePatchRadius)
      .dispatch(blocks);
  chain.output(offset, task.block);
}

BurstMergePasses::BurstMergePasses(gpu::Device& device, const BurstTask& task, int limit_px, Extent target,
                                   Extent source)
    : chain(device, "merge") {
  reference = chain.input("reference", Format::f32, target);
  frame = chain.input("frame", Format::f32, source);
  offset = chain.input("offset", Format::f32x2, in_blocks(task, target));
  before = chain.input("accumulated.before", Format::f32x2, target);
  colors = colors_table(chain, task);
  weights = chain.table("weights", Format::f32, {static_cast<int>(cfa_weight_count(task.cfa)), 1});
  levels = levels_table(chain);
  target_place = chain.table("target_place", Format::f32x2, {1, 1});
  source_place = chain.table("source_place", Format::f32x2, {1, 1});
  target_origin = chain.table("target_origin", Format::f32x2, {1, 1});

  // At the border, samples are read a period before.
  const int taps_px = std::max(kCfaTaps - kCfaBefore, task.cfa.period);
  const ImageId warped = chain.image("warped", Format::f32x2, target);
  chain.pass("burst/warp")
      .read("mosaic", frame, gpu::gather(limit_px + taps_px))
      .read("offset", offset, gpu::bilinear(task.block))
      .read("colors", colors)
      .read("weights", weights)
      .read("levels", levels)
      .read("target_place", target_place)
      .read("source_place", source_place)
      .read("target_origin", target_origin)
      .write("warped", warped)
      .specialize("period", task.cfa.period)
      .specialize("block", task.block)
      .specialize("taps", kCfaTaps)
      .specialize("before", kCfaBefore)
      .specialize("steps", kCfaSteps)
      .dispatch(target);

  const ImageId difference = chain.image("difference", Format::f32x2, target);
  chain.pass("burst/difference")
      .read("reference", reference)
      .read("warped", warped)
      .read("colors", colors)
      .read("levels", levels)
      .read("place", target_place)
      .write("difference", difference)
      .specialize("period", task.cfa.period)
      .dispatch(target);
  const ImageId sums = chain.image("difference.columns", Format::f32x4, target.with_planes(2));
  chain.pass("burst/sum_noise_column")
      .read("difference", difference, gpu::reach(0, kMergePatchRadius))
      .write("sums", sums)
      .specialize("radius", kMergePatchRadius)
      .dispatch(target);
  after = chain.image("accumulated.after", Format::f32x2, target);
  chain.pass("burst/accumulate")
      .read("reference", reference)
      .read("warped", warped)
      .read("difference", difference)
      .read("sums", sums, gpu::reach(kMergePatchRadius, 0))
      .read("levels", levels)
      .read("before", before)
      .write("after", after)
      .specialize("radius", kMergePatchRadius)
      .dispatch(target);
  chain.output(after);
}

}  // namespace becalm::filter
