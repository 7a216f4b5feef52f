#include "filter/correct.h"

#include <fmt/format.h>

#include <vector>

#include "filter/ceil_div.h"
#include "shaders/shared/correct_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

/// What tells the noise of the frame's block means; the values of shaders/correct/difference.comp.
enum class NoiseSource { variance, halves, mean_of_both };

NoiseSource noise_source(const Settings& settings, const CorrectionInputs& inputs) {
  if (!inputs.half_difference) return NoiseSource::variance;
  return settings.smooth == Smooth::none ? NoiseSource::halves : NoiseSource::mean_of_both;
}

/// Sums over the blocks of one level. A pixel is the sum of its block at level 0, where the frame has no
/// count of pixels yet and the estimate not the frame's variance.
struct BlockSums {
  Extent extent;
  ImageId frame;
  ImageId estimate;
  ImageId halves;  ///< of any content unless there are half-buffers
};

Extent half(Extent extent) {
  return {ceil_div(extent.width, 2), ceil_div(extent.height, 2)};
}

params::BlockParams block_params(Extent out, Extent in) {
  return {.width = out.width, .height = out.height, .width_in = in.width, .height_in = in.height};
}

std::vector<BlockSums> add_block_sums(Chain& chain, int levels, Extent full, const CorrectionInputs& inputs) {
  const bool has_halves = inputs.half_difference.has_value();
  const auto image = [&](const char* what, std::size_t level, Extent extent) {
    return chain.image(fmt::format("correction.{}.L{}", what, level), Format::f32x4, extent);
  };
  const Extent finest = half(full);
  std::vector<BlockSums> sums{
      {full, inputs.color, inputs.estimate, inputs.half_difference.value_or(inputs.color)},
      {finest, image("frame_sums", 1, finest), image("estimate_sums", 1, finest),
       image("half_sums", 1, has_halves ? finest : Extent{1, 1})}};
  chain.pass("correct/block_sums")
      .read("color", inputs.color)
      .read("variance", inputs.variance)
      .read("estimate", inputs.estimate)
      .read("estimate_stats", inputs.estimate_stats)
      .read("half_difference", sums[0].halves)
      .specialize("halves", has_halves ? 1 : 0)
      .write("frame_sums", sums[1].frame)
      .write("estimate_sums", sums[1].estimate)
      .write("half_sums", sums[1].halves)
      .constants(block_params(finest, full))
      .dispatch(finest);
  for (std::size_t l = 2; l <= static_cast<std::size_t>(levels); ++l) {
    const BlockSums fine = sums.back();
    const Extent extent = half(fine.extent);
    const auto coarser = [&](const char* what, ImageId from) {
      const ImageId to = image(what, l, extent);
      chain.pass("correct/coarser_sums")
          .read("fine", from)
          .write("coarse", to)
          .constants(block_params(extent, fine.extent))
          .dispatch(extent);
      return to;
    };
    sums.push_back({extent, coarser("frame_sums", fine.frame), coarser("estimate_sums", fine.estimate),
                    has_halves ? coarser("half_sums", fine.halves) : fine.halves});
  }
  return sums;
}

}  // namespace

Corrected add_correction_passes(Chain& chain, const Settings& settings, Extent full,
                                const CorrectionInputs& inputs) {
  const std::vector<BlockSums> sums = add_block_sums(chain, settings.correct_levels, full, inputs);
  Extent extent{1, 1};
  ImageId factor = chain.image("correction.one", Format::f32x4, extent);
  chain.pass("correct/one").write("factor", factor).dispatch(extent);
  for (std::size_t l = sums.size(); l-- > 0;) {
    const BlockSums& level = sums[l];
    const ImageId difference =
        chain.image(fmt::format("correction.difference.L{}", l), Format::f32x4, level.extent);
    const ImageId base = chain.image(fmt::format("correction.base.L{}", l), Format::f32x4, level.extent);
    chain.pass("correct/difference")
        .read("frame_sums", level.frame)
        .read("estimate_sums", level.estimate)
        .read("half_sums", level.halves)
        .read("variance", inputs.variance)
        .read("estimate_stats", inputs.estimate_stats)
        .read("coarser", factor)
        .read("exposure", inputs.exposure)
        .specialize("noise_source", static_cast<int>(noise_source(settings, inputs)))
        .specialize("of_pixels", l == 0 ? 1 : 0)
        .write("difference", difference)
        .write("base", base)
        .constants(block_params(level.extent, extent))
        .dispatch(level.extent);
    const ImageId finer = chain.image(fmt::format("correction.factor.L{}", l), Format::f32x4, level.extent);
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
  Corrected corrected{apply(inputs.estimate, "correction.corrected"), {}};
  for (std::size_t i = 0; i < inputs.additive.size(); ++i) {
    corrected.additive.push_back(apply(inputs.additive[i], fmt::format("correction.additive.{}", i)));
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
