#pragma once

#include <optional>
#include <string>

#include "filter/align/align.h"
#include "filter/antialias/antialias_settings.h"
#include "filter/gpu/chain.h"
#include "filter/merge/merge.h"
#include "frame/aov.h"

namespace becalm::filter {

/// What the passes of antialiasing depend on.
struct AntialiasTask {
  AntialiasSettings settings;
  gpu::Extent full;          ///< of the results
  gpu::Extent sampled = {};  ///< of the frames; 0: that of the results
  Imath::V2i origin{0, 0};   ///< the frames' first pixel, in the image plane
  AovSet used;               ///< AOVs that are read besides the beauty
  AovSet diagnostics;        ///< diagnostic AOVs in the results

  /// Whether samples are sparser than the results' pixels: with a scale, or of a checkerboard.
  bool is_sparse() const { return settings.checkerboard || !settings.scale.is_one(); }
  /// Whether the samples' positions within their pixels are used. With sparse samples they always are: the
  /// pixels between samples are reconstructed from positions.
  bool uses_places() const { return is_sparse() || settings.reconstruct; }
  /// Of the results' first pixel: Scale::rounding.
  Imath::V2f edge() const {
    return {static_cast<float>(settings.scale.rounding(origin.x)),
            static_cast<float>(settings.scale.rounding(origin.y))};
  }
  gpu::Extent samples() const { return sampled.width > 0 ? sampled : full; }
  bool has_motion() const { return contains(used, Aov::motion) && settings.uses_vectors(); }
};

/// Settings of the aligner and the combination for frames of little noise, which are matched by radiance
/// alone at full size.
Settings aligner_settings(const AntialiasTask& task);

/// Where samples are sparser than pixels: SparseGrid::columns and rows, as f32x4 of two rows.
struct SparseTables {
  gpu::ImageId columns;
  gpu::ImageId rows;
};

/// Antialiases one frame after another: reprojection, accumulation. Frames are whole: the history
/// stays on the device. Unless the grid is sparse, all images are shifted by SampleGrid::shift.
struct AntialiasChain {
  AntialiasChain(gpu::Device& device, const AntialiasTask& task);

  gpu::Chain chain;
  gpu::ImageId samples;  ///< f32x4: the frame, non-finite pixels replaced
  gpu::ImageId finite;   ///< f32: 1, or 0 for a pixel that is not finite, lies outside or has no sample
  std::optional<gpu::ImageId> weights;      ///< f32, 10x1: SampleGrid::weights; or
  std::optional<SparseTables> grid;         ///< of the results' pixels
  std::optional<SparseTables> search_grid;  ///< of the samples' pixels, if the search has them
  gpu::ImageId exposure;                    ///< f32, 1x1: of the frame, for the search
  gpu::ImageId history_exposure;            ///< the same for the history, which is in the last frame's scale
  gpu::ImageId ratio;                       ///< f32, 1x1: of the frame's scale to the history's
  std::optional<gpu::ImageId> motion;       ///< f32x2: from pack_motion
  std::optional<gpu::ImageId> depth;        ///< f32: finite everywhere

  gpu::History color;
  gpu::History stats;
  WarpedHistory warped;
  /// f32x4: rejected share of the history; its squared bias; weight of the new frame; confidence of the new
  /// frame's pixel, in frames: 1 where samples are not sparse.
  gpu::ImageId decision;
  std::optional<gpu::ImageId> rectified;  ///< f32x4: the warped history, if it is rectified and predicts
  gpu::ImageId offset;                    ///< f32x2: of the history
  gpu::ImageId prediction() const { return rectified ? *rectified : warped.color; }

 private:
  struct Reconstructed {
    gpu::ImageId color;     ///< f32x4
    gpu::ImageId variance;  ///< f32x2: variance; confidence, 1 for a pixel of a whole frame, 0 for none
  };
  SparseTables add_tables(gpu::Extent extent, const std::string& name);
  Reconstructed add_reconstruction(gpu::Extent extent, const std::optional<SparseTables>& tables,
                                   const std::string& name, std::optional<gpu::ImageId> into = {});
  gpu::ImageId add_motion(const AntialiasTask& task);
  Alignment add_search(const AntialiasTask& task, gpu::ImageId reconstructed);
  void add_reprojection(const AntialiasTask& task, gpu::ImageId reconstructed);
  void add_light(const AntialiasTask& task, gpu::ImageId reconstructed);
  void add_accumulation(const AntialiasTask& task, gpu::ImageId reconstructed);

  gpu::ImageId variance_;                 ///< f32x2: Reconstructed::variance
  std::optional<gpu::ImageId> residual_;  ///< of the search's finest level
};

}  // namespace becalm::filter
