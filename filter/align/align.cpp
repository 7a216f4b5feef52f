#include "filter/align/align.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "filter/ceil_div.h"
#include "shaders/shared/align_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

int blur_radius(const Settings& settings, std::size_t level) {
  return settings.blur_radius[std::min(level, settings.blur_radius.size() - 1)];
}

int refines(const Settings& settings, std::size_t level) {
  return static_cast<int>(level) < settings.refine_levels ? 1 : 0;
}

struct CoarseOffset {
  ImageId image;
  int factor;  ///< how many times smaller the image is than the level that reads it

  float scale() const { return static_cast<float>(factor); }
};

/// Footprint of a read of a level's source at offsets of at most `limit_px` full-resolution pixels, by a
/// patch of this radius.
gpu::Footprint gather_source(const Settings& settings, std::size_t level, int limit_px, int radius = 0) {
  return gpu::gather(ceil_div(limit_px, level_px(settings, level)) + radius);
}

/// Warps the source's features to the target's pixels by the level's start offsets.
ImageId add_warp(Chain& chain, const Settings& settings, const Search& search, std::size_t level,
                 Extent extent, const Features& source, const CoarseOffset& coarse, int limit_px) {
  const ImageId warped =
      chain.image(fmt::format("features.warped.L{}", level), Format::f32, extent.with_planes(source.planes));
  chain.pass("align/warp_source")
      .read("source", source.image, gather_source(settings, level, limit_px))
      .read("offset_coarse", coarse.image, gpu::bilinear(coarse.factor))
      .read("target_origin", search.window.target_origin)
      .write("warped", warped)
      .specialize("planes", source.planes)
      .constants(
          params::WarpSourceParams{.level_px = level_px(settings, level), .coarse_scale = coarse.scale()})
      .dispatch(extent);
  return warped;
}

/// Start offsets of a level: per pixel the coarser level's offset or the known motion, whichever has the
/// smaller distance.
CoarseOffset add_motion_guide(Chain& chain, const Settings& settings, const Search& search, std::size_t level,
                              const Features& target, const Features& source, const CoarseOffset& coarse,
                              int limit_px) {
  constexpr int patch_radius = 2;  // of both starts that are compared
  const Extent extent = level_extent(settings, search.full, level);
  const ImageId start = chain.image("offset.guided", Format::f32x2, extent);
  chain.pass("align/choose_start")
      .read("target", target.image, gpu::reach(patch_radius))
      .read("source", source.image, gather_source(settings, level, limit_px, patch_radius))
      .read("offset_coarse", coarse.image, gpu::bilinear(coarse.factor))
      .read("motion", *search.motion, gpu::block(level_px(settings, level)))
      .read("target_origin", search.window.target_origin)
      .write("start", start)
      .specialize("radius", patch_radius)
      .constants(params::ChooseStartParams{
          .planes = target.planes, .coarse_scale = coarse.scale(), .level_px = level_px(settings, level)})
      .dispatch(extent);
  return {start, 1};
}

/// Inputs and outputs of the search at one level.
struct Level {
  std::size_t index;
  Extent extent;
  int radius;
  int channels;
  ImageId target;
  ImageId warped;
  CoarseOffset coarse;
  ImageId offset;
  ImageId residual;
};

/// Largest sum of two pixels' feature differences, for weights of about 1.
constexpr double kLargestDifference = 8.0 * kFeatureRange;

/// The largest product of factors 1 + d/2 that stays within the range of floats: that of a patch (0), of a
/// column (1) or of one pixel (2). Constant `log_of` of align/match.comp.
int log_of(int radius) {
  constexpr double largest_log2 = 126.0;
  const double factor_log2 = std::log2(1.0 + 0.5 * kLargestDifference);
  const int side = 2 * radius + 1;
  return factor_log2 * side * side < largest_log2 ? 0 : factor_log2 * side < largest_log2 ? 1 : 2;
}

/// Pixels that one invocation of align/match computes.
struct Strip {
  int columns;
  int rows;
};

/// On a software device with eight lanes reads are the main cost, so strips are large. Columns multiply the
/// time that the driver compiles: of 1920x1080 px 16 columns are matched 3 % faster than 8 and compiled 0.5 s
/// longer; in small images compilation is the main cost. Results do not depend on columns. Hardware needs
/// many invocations: of 1, 2 and 4 columns, 4 are the fastest on an NVIDIA H100 with patches of 13x13.
Strip match_strip(const gpu::DeviceInfo& device, Extent finest) {
  constexpr std::size_t small_px = 256 * 256;
  if (!device.is_processor) return {4, 16};
  return {finest.elements() <= small_px ? 1 : 8, 32};
}

/// Searches the level in one pass that stores no distances in memory.
void add_match(Chain& chain, const Settings& settings, const Level& level, const Strip& strip) {
  // Sums slide down each strip: a pixel has the rounding errors of all rows above it in the strip.
  const auto patch = [&](int shift) { return gpu::in_runs_of(strip.rows, gpu::reach(level.radius + shift)); };
  chain.pass("align/match")
      .read("target", level.target, patch(0))
      .read("warped", level.warped, patch(kWindowReach))
      .read("offset_coarse", level.coarse.image, gpu::bilinear(level.coarse.factor, kWindowReach))
      .write("offset", level.offset)
      .write("residual", level.residual)
      .specialize("kind", static_cast<int>(settings.distance))
      .specialize("channels", level.channels)
      .specialize("radius", level.radius)
      .specialize("strip_columns", strip.columns)
      .specialize("strip_rows", strip.rows)
      .specialize("log_of", log_of(level.radius))
      .constants(
          params::MatchParams{.coarse_scale = level.coarse.scale(), .refine = refines(settings, level.index)})
      .dispatch({ceil_div(level.extent.width, strip.columns), ceil_div(level.extent.height, strip.rows)});
}

}  // namespace

SourceWindow add_same_window(Chain& chain, Extent full, const std::string& name) {
  const ImageId origin = chain.image(name, Format::f32x2, {1, 1});
  chain.fill(origin, 0.0f);
  return {full, origin};
}

SearchResult add_search_passes(Chain& chain, const Settings& settings, const Search& search) {
  assert(search.target.planes == search.source.planes && search.levels.finest < search.levels.end);
  const auto [finest, end] = search.levels;
  const std::vector<Features> targets =
      add_pyramid(chain, settings, search.levels, search.full, search.target, "target");
  const std::vector<Features> sources =
      add_pyramid(chain, settings, search.levels, search.window.full, search.source, "source");

  const int motion_limit_px = search.motion ? search.motion_limit_px : 0;
  const auto limit_after = [&, end = end](std::size_t level) {
    return offset_limit_px(settings, {level, end}, search.start_limit_px, motion_limit_px);
  };
  SearchResult result{.offset = {}, .residual = {}, .limit_px = limit_after(finest)};
  CoarseOffset coarse;
  if (search.start) {
    coarse = {*search.start, settings.pyramid.factor};
  } else {
    coarse = {chain.image("offset.none", Format::f32x2, {1, 1}), 1};
    chain.fill(coarse.image, 0.0f);
  }
  const Strip strip = match_strip(chain.device(), level_extent(settings, search.full, finest));
  for (std::size_t l = end; l-- > finest;) {
    const Extent extent = level_extent(settings, search.full, l);
    const ImageId residual = chain.image(fmt::format("residual.L{}", l), Format::f32, extent);
    result.residual = residual;
    const Features& target = targets[l - finest];
    const Features& source = sources[l - finest];
    int limit_px = limit_after(l + 1);
    if (search.motion && l == motion_level(end)) {
      limit_px = std::max(limit_px, motion_limit_px);
      coarse = add_motion_guide(chain, settings, search, l, target, source, coarse, limit_px);
    }
    const Level level{.index = l,
                      .extent = extent,
                      .radius = blur_radius(settings, l),
                      .channels = search.target.planes,
                      .target = target.image,
                      .warped = add_warp(chain, settings, search, l, extent, source, coarse, limit_px),
                      .coarse = coarse,
                      .offset = chain.image(fmt::format("offset_noisy.L{}", l), Format::f32x2, extent),
                      .residual = residual};
    add_match(chain, settings, level, strip);
    const ImageId offset = chain.image(fmt::format("offset.L{}", l), Format::f32x2, extent);
    chain.pass("align/median_offset")
        .read("offset_noisy", level.offset, gpu::reach(1))
        .write("offset", offset)
        .dispatch(extent);
    coarse = {offset, settings.pyramid.factor};
  }
  result.offset = coarse.image;
  return result;
}

ImageId add_upsample_pass(Chain& chain, const Settings& settings, Extent full, ImageId offset) {
  if (settings.match_downsample == 1) return offset;
  const Extent extent = level_extent(settings, full, 0);
  const ImageId upsampled = chain.image("offset.full", Format::f32x2, full);
  chain.pass("align/upsample_offset")
      .read("offset_coarse", offset, gpu::bilinear(settings.match_downsample))
      .write("offset", upsampled)
      .specialize("scale", settings.match_downsample)
      .dispatch({extent.width, full.height});
  return upsampled;
}

ImageId add_override_pass(Chain& chain, Extent full, ImageId offset, ImageId motion) {
  const ImageId overridden = chain.image("offset.overridden", Format::f32x2, full);
  chain.pass("align/override_offset")
      .read("found", offset)
      .read("motion", motion)
      .write("offset", overridden)
      .dispatch(full);
  return overridden;
}

Alignment add_alignment(Chain& chain, const Settings& settings, const Search& search) {
  assert(search.levels.finest == 0);
  Search guided = search;
  if (settings.motion != MotionUse::guide) guided.motion.reset();
  const SearchResult found = add_search_passes(chain, settings, guided);
  Alignment alignment{.offset = add_upsample_pass(chain, settings, search.full, found.offset),
                      .residual = found.residual,
                      .limit_px = found.limit_px};
  if (search.motion && settings.motion == MotionUse::override_offset) {
    alignment.offset = add_override_pass(chain, search.full, alignment.offset, *search.motion);
    alignment.limit_px = search.motion_limit_px;
  }
  return alignment;
}

Alignment add_align_passes(Chain& chain, const Settings& settings, Extent full, const Features& target,
                           const Features& source, std::optional<ImageId> motion) {
  return add_alignment(chain, settings,
                       {.levels = {0, pyramid_extents(settings, full.width, full.height).size()},
                        .full = full,
                        .window = add_same_window(chain, full, "origin.align"),
                        .target = target,
                        .source = source,
                        .start = {},
                        .motion = motion,
                        .motion_limit_px = largest_motion_px(settings, full)});
}

}  // namespace becalm::filter
