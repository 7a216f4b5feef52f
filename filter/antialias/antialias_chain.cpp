#include "filter/antialias/antialias_chain.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "shaders/shared/antialias_params.h"

namespace becalm::filter {

using gpu::Format;
using gpu::ImageId;

Settings aligner_settings(const AntialiasTask& task) {
  Settings settings = preset("final");
  settings.guides = false;
  settings.blur_radius = {2};
  settings.refine_levels = task.settings.refine_levels;
  settings.motion = task.has_motion() ? MotionUse::guide : MotionUse::none;
  settings.resample = task.settings.resample;
  settings.directions = task.settings.directions;
  settings.smooth = Smooth::none;
  settings.patch_radius = 1;
  return settings;
}

AntialiasChain::AntialiasChain(gpu::Device& device, const AntialiasTask& task) : chain(device, "antialias") {
  samples = chain.input("samples", Format::f32x4, task.samples());
  finite = chain.input("finite", Format::f32, task.samples());
  if (task.is_sparse()) {
    grid = add_tables(task.full, "grid");
  } else {
    weights = chain.table("weights", Format::f32, {10, 1});
  }
  exposure = chain.table("exposure", Format::f32, {1, 1});
  history_exposure = chain.table("history.exposure", Format::f32, {1, 1});
  ratio = chain.table("ratio", Format::f32, {1, 1});
  color = chain.history("history.color", Format::f32x4, task.full);
  stats = chain.history("history.stats", Format::f32x2, task.full);
  const Reconstructed reconstructed = add_reconstruction(task.full, grid, "");
  variance_ = reconstructed.variance;
  add_reprojection(task, reconstructed.color);
  add_accumulation(task, reconstructed.color);
  chain.output(color.next);
  chain.output(stats.next);
  chain.output(decision);
  if (task.settings.directions == Directions::both) {
    chain.output(prediction());
    chain.output(warped.stats);
  }
  if (contains(task.diagnostics, Aov::flow)) chain.output(offset);
}

SparseTables AntialiasChain::add_tables(gpu::Extent extent, const std::string& name) {
  return {chain.table(name + ".columns", Format::f32x4, {extent.width, 2}),
          chain.table(name + ".rows", Format::f32x4, {extent.height, 2})};
}

AntialiasChain::Reconstructed AntialiasChain::add_reconstruction(gpu::Extent extent,
                                                                 const std::optional<SparseTables>& tables,
                                                                 const std::string& name,
                                                                 std::optional<ImageId> into) {
  const Reconstructed made{into ? *into : chain.image(name + "reconstructed", Format::f32x4, extent),
                           chain.image(name + "variance", Format::f32x2, extent)};
  const gpu::Footprint around = tables ? gpu::anywhere() : gpu::reach(1);
  chain.pass("antialias/reconstruct")
      .read("samples", samples, around)
      .read("finite", finite, around)
      .read("weights", weights)
      .read("columns", tables ? std::optional(tables->columns) : std::nullopt)
      .read("rows", tables ? std::optional(tables->rows) : std::nullopt)
      .write("color", made.color)
      .write("variance", made.variance)
      .specialize("sparse", tables ? 1 : 0)
      .dispatch(extent);
  return made;
}

ImageId AntialiasChain::add_motion(const AntialiasTask& task) {
  motion = chain.input("motion", Format::f32x2, task.full);
  if (contains(task.used, Aov::depth)) depth = chain.input("depth", Format::f32, task.full);
  const ImageId dilated = chain.image("motion.dilated", Format::f32x2, task.full);
  chain.pass("antialias/dilate_motion")
      .read("motion", *motion, depth ? gpu::reach(1) : gpu::reach(0))
      .read("depth", depth, gpu::reach(1))
      .write("dilated", dilated)
      .specialize("has_depth", depth ? 1 : 0)
      .dispatch(task.full);
  return dilated;
}

/// Searches at the size of the frames. With --scale the reconstructed frames of that size are matched, one
/// with the one before it: at the size of the results a search takes longer and finds no more.
Alignment AntialiasChain::add_search(const AntialiasTask& task, ImageId reconstructed) {
  Settings settings = aligner_settings(task);
  const gpu::Extent extent = task.samples();
  const bool is_scaled = extent != task.full;
  ImageId target = reconstructed;
  ImageId source = color.previous;
  if (is_scaled) {
    search_grid = add_tables(extent, "search.grid");
    settings.motion = MotionUse::none;
    const gpu::History searched = chain.history("searched", Format::f32x4, extent);
    target = add_reconstruction(extent, search_grid, "search.", searched.next).color;
    source = searched.previous;
  }
  const auto features = [&](const std::string& name, ImageId image, ImageId exposure_of_image) {
    return add_feature_passes(
        chain, settings, extent, name,
        {.color = image, .exposure = exposure_of_image, .guide_features = {}, .guide_planes = 0});
  };
  Alignment found =
      add_align_passes(chain, settings, extent, features("target", target, exposure),
                       features("source", source, history_exposure), is_scaled ? std::nullopt : motion);
  if (!is_scaled) return found;
  const ImageId scaled = chain.image("search.offset", Format::f32x2, task.full);
  const auto scale = static_cast<float>(task.settings.scale.value());
  chain.pass("antialias/scale_offset")
      .read("offset_coarse", found.offset, gpu::anywhere())
      .write("offset", scaled)
      .constants(params::ScaleOffsetParams{.scale = scale, .edge_x = task.edge().x, .edge_y = task.edge().y})
      .dispatch(task.full);
  found.offset = scaled;
  found.limit_px = static_cast<int>(std::ceil(scale * static_cast<float>(found.limit_px)));
  return found;
}

void AntialiasChain::add_reprojection(const AntialiasTask& task, ImageId reconstructed) {
  std::optional<ImageId> vectors;
  if (task.has_motion()) vectors = add_motion(task);
  int limit_px = std::max(task.full.width, task.full.height);  // of vectors
  if (vectors) offset = *vectors;
  if (!vectors || task.settings.searches() || task.settings.mask) {
    const Alignment found = add_search(task, reconstructed);
    residual_ = found.residual;
    if (!vectors) {
      offset = found.offset;
      limit_px = found.limit_px;
    } else if (task.settings.searches()) {
      offset = add_override_pass(chain, task.full, found.offset, *vectors);
    }
  }
  warped = add_warp_passes(chain, aligner_settings(task), task.full,
                           {.color = color.previous, .stats = stats.previous, .offset_limit_px = limit_px},
                           offset);
  chain.pass("antialias/rescale")
      .read("ratio", ratio)
      .read_write("color", warped.color)
      .read_write("stats", warped.stats)
      .dispatch(task.full);
  if (task.settings.accumulate == Accumulate::variance) add_light(task, reconstructed);
}

void AntialiasChain::add_light(const AntialiasTask& task, ImageId reconstructed) {
  const auto tiles = [](int side) { return (side + params::kTile - 1) / params::kTile; };
  const gpu::Extent extent{tiles(task.full.width), tiles(task.full.height)};
  const ImageId of_frame = chain.image("light.frame", Format::f32x4, extent);
  const ImageId of_history = chain.image("light.history", Format::f32x4, extent);
  const ImageId light = chain.image("light", Format::f32x4, extent);
  chain.pass("antialias/tile_light")
      .read("color", reconstructed, gpu::anywhere())
      .read("variance", variance_, gpu::anywhere())
      .read("warped_color", warped.color, gpu::anywhere())
      .read("warped_stats", warped.stats, gpu::anywhere())
      .write("of_frame", of_frame)
      .write("of_history", of_history)
      .dispatch(extent);
  chain.pass("antialias/light_ratio")
      .read("of_frame", of_frame, gpu::anywhere())
      .read("of_history", of_history, gpu::anywhere())
      .write("light", light)
      .dispatch(extent);
  chain.pass("antialias/follow_light")
      .read("light", light, gpu::anywhere())
      .read_write("color", warped.color)
      .read_write("stats", warped.stats)
      .dispatch(task.full);
}

void AntialiasChain::add_accumulation(const AntialiasTask& task, ImageId reconstructed) {
  const AntialiasSettings& settings = task.settings;
  if (settings.directions == Directions::both && settings.rectify != Rectify::none)
    rectified = chain.image("rectified", Format::f32x4, task.full);
  decision = chain.image("decision", Format::f32x4, task.full);
  const gpu::Footprint around = grid ? gpu::anywhere() : gpu::reach(1);
  const int bias_radius = grid ? 2 : 1;  // sparse samples tell as much on more pixels
  const gpu::Footprint compared = gpu::reach(bias_radius);
  chain.pass("antialias/accumulate")
      .read("samples", samples, around)
      .read("finite", finite, around)
      .read("color", reconstructed, compared)
      .read("variance", variance_, compared)
      .read("warped_color", warped.color, compared)
      .read("warped_stats", warped.stats, compared)
      .read("residual", settings.mask ? residual_ : std::nullopt,
            task.samples() == task.full ? gpu::bilinear(1) : gpu::anywhere())
      .read("columns", grid ? std::optional(grid->columns) : std::nullopt)
      .read("rows", grid ? std::optional(grid->rows) : std::nullopt)
      .read("offset", grid ? std::optional(offset) : std::nullopt)
      .write("merged_color", color.next)
      .write("merged_stats", stats.next)
      .write("decision", decision)
      .write("rectified", rectified)
      .specialize("rule", static_cast<int>(settings.accumulate))
      .specialize("rectify", settings.rectify == Rectify::clamp ? 1 : 0)
      .specialize("by_deviation", settings.bounds == Bounds::deviation ? 1 : 0)
      .specialize("masked", settings.mask ? 1 : 0)
      .specialize("sparse", grid ? 1 : 0)
      .specialize("keeps_rectified", rectified ? 1 : 0)
      .specialize("bias_radius", bias_radius)
      .constants(params::AccumulateParams{.residual_scale = static_cast<float>(settings.scale.value()),
                                          .edge_x = task.edge().x,
                                          .edge_y = task.edge().y})
      .dispatch(task.full);
}

}  // namespace becalm::filter
