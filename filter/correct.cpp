#include "filter/correct.h"

#include <fmt/format.h>

#include <vector>

#include "shaders/shared/correct_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

/// Sums over the blocks of one level.
struct BlockSums {
  Extent extent;
  ImageId frame;
  ImageId estimate;
  ImageId halves;
};

Extent half(Extent extent) {
  return {(extent.width + 1) / 2, (extent.height + 1) / 2};
}

params::BlockParams block_params(Extent out, Extent in) {
  return {.width = out.width, .height = out.height, .width_in = in.width, .height_in = in.height};
}

std::vector<BlockSums> add_block_sums(Chain& chain, int levels, Extent full, const CorrectionInputs& inputs,
                                      const std::string& name) {
  const auto sums_of = [&](std::size_t level, Extent extent) {
    return BlockSums{extent,
                     chain.image(fmt::format("{}.frame_sums.L{}", name, level), Format::f32x4, extent),
                     chain.image(fmt::format("{}.estimate_sums.L{}", name, level), Format::f32x4, extent),
                     chain.image(fmt::format("{}.half_sums.L{}", name, level), Format::f32x4, extent)};
  };
  std::vector<BlockSums> sums{sums_of(0, full)};
  chain.pass("correct/block_sums")
      .read("color", inputs.color)
      .read("variance", inputs.variance)
      .read("estimate", inputs.estimate)
      .read("estimate_stats", inputs.estimate_stats)
      .read("half_difference", inputs.half_difference.value_or(inputs.color))
      .specialize("halves", inputs.half_difference ? 1 : 0)
      .write("frame_sums", sums[0].frame)
      .write("estimate_sums", sums[0].estimate)
      .write("half_sums", sums[0].halves)
      .constants(block_params(sums[0].extent, full))
      .dispatch(sums[0].extent);
  for (std::size_t l = 1; l <= static_cast<std::size_t>(levels); ++l) {
    const BlockSums fine = sums.back();
    sums.push_back(sums_of(l, half(fine.extent)));
    const auto add = [&](ImageId from, ImageId to) {
      chain.pass("correct/coarser_sums")
          .read("fine", from)
          .write("coarse", to)
          .constants(block_params(sums[l].extent, fine.extent))
          .dispatch(sums[l].extent);
    };
    add(fine.frame, sums[l].frame);
    add(fine.estimate, sums[l].estimate);
    add(fine.halves, sums[l].halves);
  }
  return sums;
}

}  // namespace

Corrected add_correction_passes(Chain& chain, const Settings& settings, Extent full,
                                const CorrectionInputs& inputs, const std::string& name) {
  const std::vector<BlockSums> sums = add_block_sums(chain, settings.correct_levels, full, inputs, name);
  Extent extent{1, 1};
  ImageId factor = chain.image(name + ".one", Format::f32x4, extent);
  chain.pass("correct/one").write("factor", factor).dispatch(extent);
  for (std::size_t l = sums.size(); l-- > 0;) {
    const BlockSums& level = sums[l];
    const ImageId difference =
        chain.image(fmt::format("{}.difference.L{}", name, l), Format::f32x4, level.extent);
    const ImageId base = chain.image(fmt::format("{}.base.L{}", name, l), Format::f32x4, level.extent);
    chain.pass("correct/difference")
        .read("frame_sums", level.frame)
        .read("estimate_sums", level.estimate)
        .read("coarser", factor)
        .read("exposure", inputs.exposure)
        .read("half_sums", level.halves)
        .specialize("halves", inputs.half_difference ? 1 : 0)
        .write("difference", difference)
        .write("base", base)
        .constants(block_params(level.extent, extent))
        .dispatch(level.extent);
    const ImageId finer = chain.image(fmt::format("{}.factor.L{}", name, l), Format::f32x4, level.extent);
    chain.pass("correct/factor")
        .read("difference", difference)
        .read("base", base)
        .read("coarser", factor)
        .write("factor", finer)
        .constants(block_params(level.extent, extent))
        .dispatch(level.extent);
    factor = finer;
    extent = level.extent;
  }
  const auto apply = [&](ImageId estimate, const std::string& corrected_name) {
    const ImageId corrected = chain.image(corrected_name, Format::f32x4, full);
    chain.pass("correct/apply")
        .read("estimate", estimate)
        .read("coarser", factor)
        .write("corrected", corrected)
        .constants(block_params(full, extent))
        .dispatch(full);
    return corrected;
  };
  Corrected corrected{apply(inputs.estimate, name + ".corrected"), {}};
  for (std::size_t i = 0; i < inputs.additive.size(); ++i) {
    corrected.additive.push_back(apply(inputs.additive[i], fmt::format("{}.additive.{}", name, i)));
  }
  return corrected;
}

int correction_margin_px(const Settings& settings) {
  // Each level reads two blocks more on either side, and the bilinear read of a coarser one half of that and
  // a block: never more than five of the largest blocks away from the pixel's own.
  return settings.correct_levels > 0 ? 6 << settings.correct_levels : 0;
}

int correction_grid_px(const Settings& settings) {
  return 1 << settings.correct_levels;
}

}  // namespace becalm::filter
