#include "filter/align.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "shaders/shared/align_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

constexpr int kShifts = 25;  // [-2,2]^2
constexpr int kWindowReach = 2;
constexpr int kSmallestLevel = 8;  // px; below, a patch is the whole image
constexpr double kReachOfLongerSide = 0.09;

// Range of the matching features. The logarithm of eq. 4 bends at differences of about 2 and the center
// weight of eq. 5 raises the distance of equal pixels, log 2, by up to half of it: on features in [0,1] it
// would outweigh any contrast.
constexpr float kFeatureRange = 16.0f;

// The 25 distance images of a level exist for one band of rows at a time; a band of this size stays in the
// last-level cache of a desktop processor and keeps the memory small whatever the image size.
constexpr std::int64_t kBandBytes = 16 << 20;
constexpr int kBlurRun = 16;  // kRun of align/blur.comp

int ceil_div(int a, int b) {
  return (a + b - 1) / b;
}

Extent shrink(Extent extent, int factor) {
  return {ceil_div(extent.width, factor), ceil_div(extent.height, factor)};
}

int blur_radius(const Settings& settings, std::size_t level) {
  return settings.blur_radius[std::min(level, settings.blur_radius.size() - 1)];
}

int refines(const Settings& settings, std::size_t level) {
  return static_cast<int>(level) < settings.refine_levels ? 1 : 0;
}

std::vector<Features> add_pyramid(Chain& chain, const Settings& settings, const std::vector<Extent>& extents,
                                  const Features& finest, const char* name) {
  std::vector<Features> levels{finest};
  for (std::size_t l = 1; l < extents.size(); ++l) {
    Extent extent = extents[l];
    extent.planes = finest.planes;
    const ImageId coarse = chain.image(fmt::format("features.{}.L{}", name, l), Format::f32, extent);
    chain.pass("align/downsample")
        .read("fine", levels.back().image)
        .write("coarse", coarse)
        .constants(params::DownsampleParams{.width_in = extents[l - 1].width,
                                            .height_in = extents[l - 1].height,
                                            .width = extent.width,
                                            .height = extent.height,
                                            .factor = settings.pyramid_factor})
        .dispatch(extent);
    levels.push_back({coarse, finest.planes});
  }
  return levels;
}

struct CoarseOffset {
  ImageId image;
  Extent extent;
  float scale;
};

/// The source's features as the target's pixels see them from where the level starts.
ImageId add_warp(Chain& chain, std::size_t level, Extent extent, const Features& source,
                 const CoarseOffset& coarse) {
  const ImageId warped = chain.image(fmt::format("features.warped.L{}", level), Format::f32,
                                     {extent.width, extent.height, source.planes});
  chain.pass("align/warp_source")
      .read("source", source.image)
      .read("offset_coarse", coarse.image)
      .write("warped", warped)
      .constants(params::WarpSourceParams{.width = extent.width,
                                          .height = extent.height,
                                          .planes = source.planes,
                                          .coarse_width = coarse.extent.width,
                                          .coarse_height = coarse.extent.height,
                                          .coarse_scale = coarse.scale})
      .dispatch(extent);
  return warped;
}

/// What a level is searched in and where its result goes.
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

/// Largest radius that `match` is faster for than the bands (shaders/align/README.md has the figures).
constexpr int kLargestMatchRadius = 10;

/// How many factors 1 + d/2 a product may have before it leaves the range of floats (log_of in
/// align/match.comp).
int log_of(int radius, double largest_difference) {
  constexpr double largest_log2 = 126.0;
  const double factor_log2 = std::log2(1.0 + 0.5 * largest_difference);
  const int side = 2 * radius + 1;
  return factor_log2 * side * side < largest_log2 ? 0 : factor_log2 * side < largest_log2 ? 1 : 2;
}

/// What one invocation of align/match makes.
struct Strip {
  int columns;
  int rows;
};

/// A software device has eight lanes, no registers to run out of and pays for every read; hardware wants many
/// small invocations whose 25 sums a column stay in registers.
Strip match_strip(const gpu::DeviceInfo& device) {
  return device.type == "software" ? Strip{8, 32} : Strip{2, 16};
}

/// The level in one pass whose distances never leave the processor.
void add_match(Chain& chain, const Settings& settings, const Level& level, double largest_difference) {
  const Strip strip = match_strip(chain.device());
  chain.pass("align/match")
      .read("target", level.target)
      .read("warped", level.warped)
      .read("offset_coarse", level.coarse.image)
      .write("offset", level.offset)
      .write("residual", level.residual)
      .specialize("kind", static_cast<int>(settings.distance))
      .specialize("channels", level.channels)
      .specialize("radius", level.radius)
      .specialize("strip_columns", strip.columns)
      .specialize("strip_rows", strip.rows)
      .specialize("log_of", log_of(level.radius, largest_difference))
      .constants(params::MatchParams{.width = level.extent.width,
                                     .height = level.extent.height,
                                     .coarse_width = level.coarse.extent.width,
                                     .coarse_height = level.coarse.extent.height,
                                     .coarse_scale = level.coarse.scale,
                                     .refine = refines(settings, level.index)})
      .dispatch({ceil_div(level.extent.width, strip.columns), ceil_div(level.extent.height, strip.rows)});
}

/// The level in bands: distances, blur and choice. The cost hardly depends on the radius, since sums slide.
void add_bands(Chain& chain, const Settings& settings, const Level& level) {
  const auto [width, height, planes] = level.extent;
  const int radius = level.radius;
  const int kind = static_cast<int>(settings.distance);
  const std::int64_t row_bytes = std::int64_t(width) * kShifts * sizeof(float);
  const int band =
      std::clamp(static_cast<int>(kBandBytes / row_bytes) - 2 * radius, std::min(16, height), height);
  const ImageId distances = chain.image(fmt::format("distances.L{}", level.index), Format::f32,
                                        {width, band + 2 * radius, kShifts});
  const ImageId row_sums =
      chain.image(fmt::format("row_sums.L{}", level.index), Format::f32, {width, band + 2 * radius, kShifts});
  const ImageId patch_sums =
      chain.image(fmt::format("patch_sums.L{}", level.index), Format::f32, {width, band, kShifts});

  for (int first_row = 0; first_row < height; first_row += band) {
    const int rows = std::min(band, height - first_row);
    const int rows_in = rows + 2 * radius;
    chain.pass("align/distance")
        .read("target", level.target)
        .read("warped", level.warped)
        .write("distances", distances)
        .specialize("kind", kind)
        .specialize("channels", level.channels)
        .constants(params::DistanceParams{
            .width = width, .height = height, .first_row = first_row - radius, .rows = rows_in})
        .dispatch({width, rows_in});
    chain.pass("align/blur")
        .read("distances", distances)
        .write("sums", row_sums)
        .constants(params::BlurParams{
            .width = width, .rows_in = rows_in, .rows = rows_in, .radius_x = radius, .radius_y = 0})
        .dispatch({ceil_div(width, kBlurRun), rows_in, kShifts});
    chain.pass("align/blur")
        .read("distances", row_sums)
        .write("sums", patch_sums)
        .constants(params::BlurParams{
            .width = width, .rows_in = rows_in, .rows = rows, .radius_x = 0, .radius_y = radius})
        .dispatch({width, ceil_div(rows, kBlurRun), kShifts});
    chain.pass("align/select_offset")
        .read("sums", patch_sums)
        .read("offset_coarse", level.coarse.image)
        .write("offset", level.offset)
        .write("residual", level.residual)
        .specialize("kind", kind)
        .constants(params::SelectParams{.width = width,
                                        .height = height,
                                        .first_row = first_row,
                                        .rows = rows,
                                        .radius = radius,
                                        .coarse_width = level.coarse.extent.width,
                                        .coarse_height = level.coarse.extent.height,
                                        .coarse_scale = level.coarse.scale,
                                        .refine = refines(settings, level.index)})
        .dispatch({width, rows});
  }
}

}  // namespace

std::vector<Extent> pyramid_extents(const Settings& settings, int width, int height) {
  std::vector<Extent> extents{shrink({width, height}, settings.match_downsample)};
  const double wanted_reach = kReachOfLongerSide * std::max(width, height);
  while (settings.pyramid_levels > 0 ? extents.size() < static_cast<std::size_t>(settings.pyramid_levels)
                                     : reach_px(settings, extents.size()) < wanted_reach) {
    const Extent next = shrink(extents.back(), settings.pyramid_factor);
    if (std::min(next.width, next.height) < kSmallestLevel) break;
    extents.push_back(next);
  }
  return extents;
}

int reach_px(const Settings& settings, std::size_t levels) {
  int reach = 0;
  int scale = settings.match_downsample;
  for (std::size_t l = 0; l < levels; ++l) {
    reach += kWindowReach * scale;
    scale *= settings.pyramid_factor;
  }
  return reach;
}

void add_guide_passes(Chain& chain, const Settings& settings, Extent full, ImageId guide,
                      const std::vector<float>& weights, ImageId guide_features) {
  const Extent extent = shrink(full, settings.match_downsample);
  for (std::size_t plane = 0; plane < weights.size(); ++plane) {
    chain.pass("align/guide_feature")
        .read("guide", guide)
        .write("features", guide_features)
        .constants(params::FeatureParams{.width_in = full.width,
                                         .height_in = full.height,
                                         .width = extent.width,
                                         .height = extent.height,
                                         .downsample = settings.match_downsample,
                                         .plane_in = static_cast<int>(plane),
                                         .plane = static_cast<int>(plane),
                                         .planes = 1,
                                         .weight = kFeatureRange * weights[plane]})
        .dispatch(extent);
  }
}

Features add_feature_passes(Chain& chain, const Settings& settings, Extent full, const std::string& name,
                            const FeatureSources& sources) {
  const bool radiance = settings.weight_radiance > 0.0f;
  const Extent extent = shrink(full, settings.match_downsample);
  const int planes = sources.guide_planes + (radiance ? 1 : 0);
  assert(planes > 0);
  const ImageId features =
      chain.image(fmt::format("features.{}.L0", name), Format::f32, {extent.width, extent.height, planes});
  if (sources.guide_planes > 0) {
    chain.pass("align/guide_feature")
        .read("guide", *sources.guide_features)
        .write("features", features)
        .constants(params::FeatureParams{.width_in = extent.width,
                                         .height_in = extent.height,
                                         .width = extent.width,
                                         .height = extent.height,
                                         .downsample = 1,
                                         .plane_in = 0,
                                         .plane = 0,
                                         .planes = sources.guide_planes,
                                         .weight = 1.0f})
        .dispatch({extent.width, extent.height, sources.guide_planes});
  }
  if (radiance) {
    chain.pass("align/radiance_feature")
        .read("color", sources.color)
        .read("exposure", sources.exposure)
        .write("features", features)
        .constants(params::FeatureParams{.width_in = full.width,
                                         .height_in = full.height,
                                         .width = extent.width,
                                         .height = extent.height,
                                         .downsample = settings.match_downsample,
                                         .plane_in = 0,
                                         .plane = sources.guide_planes,
                                         .planes = 1,
                                         .weight = kFeatureRange * settings.weight_radiance})
        .dispatch(extent);
  }
  return {features, planes};
}

Alignment add_align_passes(Chain& chain, const Settings& settings, Extent full, const Features& target,
                           const Features& source) {
  assert(target.planes == source.planes);
  const std::vector<Extent> extents = pyramid_extents(settings, full.width, full.height);
  const std::vector<Features> targets = add_pyramid(chain, settings, extents, target, "target");
  const std::vector<Features> sources = add_pyramid(chain, settings, extents, source, "source");

  Alignment alignment;
  alignment.residual.resize(extents.size());
  CoarseOffset coarse{chain.image("offset.none", Format::f32x2, {1, 1}), {1, 1}, 1.0f};
  chain.pass("align/zero_offset").write("offset", coarse.image).dispatch({1, 1});
  for (std::size_t l = extents.size(); l-- > 0;) {
    const Extent extent = extents[l];
    alignment.residual[l] = chain.image(fmt::format("residual.L{}", l), Format::f32, extent);
    const Level level{.index = l,
                      .extent = extent,
                      .radius = blur_radius(settings, l),
                      .channels = target.planes,
                      .target = targets[l].image,
                      .warped = add_warp(chain, l, extent, sources[l], coarse),
                      .coarse = coarse,
                      .offset = chain.image(fmt::format("offset_noisy.L{}", l), Format::f32x2, extent),
                      .residual = alignment.residual[l]};
    if (level.radius <= kLargestMatchRadius) {
      add_match(chain, settings, level, kFeatureRange * 8.0);
    } else {
      add_bands(chain, settings, level);
    }
    const ImageId offset = chain.image(fmt::format("offset.L{}", l), Format::f32x2, extent);
    chain.pass("align/median_offset")
        .read("offset_noisy", level.offset)
        .write("offset", offset)
        .constants(params::MedianParams{.width = extent.width, .height = extent.height})
        .dispatch(extent);
    coarse = {offset, extent, static_cast<float>(settings.pyramid_factor)};
  }
  alignment.offset = coarse.image;
  if (settings.match_downsample > 1) {
    alignment.offset = chain.image("offset.full", Format::f32x2, full);
    chain.pass("align/upsample_offset")
        .read("offset_coarse", coarse.image)
        .write("offset", alignment.offset)
        .constants(params::UpsampleParams{.width_in = coarse.extent.width,
                                          .height_in = coarse.extent.height,
                                          .width = full.width,
                                          .height = full.height,
                                          .scale = static_cast<float>(settings.match_downsample)})
        .dispatch(full);
  }
  return alignment;
}

}  // namespace becalm::filter
