#pragma once

#include <optional>

#include "filter/align/align.h"
#include "filter/antialias/antialias_settings.h"
#include "filter/gpu/chain.h"
#include "filter/merge/merge.h"
#include "frame/aov.h"

namespace becalm::filter {

/// What the passes of antialiasing depend on.
struct AntialiasTask {
  AntialiasSettings settings;
  gpu::Extent full;
  AovSet used;         ///< AOVs that are read besides the beauty
  AovSet diagnostics;  ///< diagnostic AOVs in the results

  bool has_motion() const { return contains(used, Aov::motion) && settings.uses_vectors(); }
  bool validates_surface() const;
  bool validates_color() const;
};

/// The aligner's settings for frames of little noise, which are matched by radiance alone at full size.
Settings aligner_settings(const AntialiasTask& task);

/// Antialiases one frame after another: reprojection, validation, accumulation. Frames are whole: the history
/// stays on the device. All images are shifted by SampleGrid::shift.
struct AntialiasChain {
  AntialiasChain(gpu::Device& device, const AntialiasTask& task);

  gpu::Chain chain;
  gpu::ImageId samples;   ///< f32x4: the frame, non-finite pixels replaced
  gpu::ImageId finite;    ///< f32: 1, or 0 for a pixel that is not finite or lies outside of the frame
  gpu::ImageId weights;   ///< f32, 10x1: SampleGrid::weights
  gpu::ImageId exposure;  ///< f32, 1x1
  std::optional<gpu::ImageId> motion;   ///< f32x2: from pack_motion
  std::optional<gpu::ImageId> depth;    ///< f32: finite everywhere
  std::optional<gpu::ImageId> surface;  ///< f32x4: normal, depth; 0 for what frames do not have
  std::optional<gpu::ImageId> object;   ///< f32: number

  gpu::History color;
  gpu::History stats;
  WarpedHistory warped;
  gpu::ImageId decision;  ///< f32x4: rejected share; squared bias; weight of the new frame; 0
  gpu::ImageId offset;    ///< f32x2: of the history; where two are compared, of the vectors

 private:
  gpu::ImageId add_reconstruction(const AntialiasTask& task);
  gpu::ImageId add_motion(const AntialiasTask& task);
  Alignment add_search(const AntialiasTask& task, gpu::ImageId reconstructed);
  WarpedHistory add_warp(const AntialiasTask& task, gpu::ImageId offset, int limit_px, const char* name);
  void add_reprojection(const AntialiasTask& task, gpu::ImageId reconstructed);
  gpu::ImageId add_validation(const AntialiasTask& task);
  void add_accumulation(const AntialiasTask& task, gpu::ImageId reconstructed);

  gpu::ImageId variance_;                 ///< f32x2: of the reconstructed frame; 1, or 0
  std::optional<gpu::ImageId> residual_;  ///< of the search's finest level
};

}  // namespace becalm::filter
