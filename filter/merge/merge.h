#pragma once

#include <optional>
#include <span>
#include <vector>

#include "filter/align/align.h"
#include "filter/gpu/chain.h"
#include "filter/settings.h"

namespace becalm::filter {

class NoisyInputs;

/// The kinds of images that are merged with the beauty's weights.
enum class Carried {
  additive,  ///< an additive AOV
  radiance,  ///< the noisy radiance, with its variance in the fourth channel
  features,  ///< albedo, depth, normal
};

/// An image (f32x4) that is merged into its history with the beauty's weights.
struct CarriedInput {
  gpu::ImageId color;  ///< as MergeInputs::color
  gpu::History history;
  Carried kind = Carried::additive;
};

/// Images that the merge reads and writes, at full resolution. All have one size, but the previous history
/// may cover a larger window.
struct MergeInputs {
  const NoisyInputs& noisy;  ///< the new frame, not smoothed
  gpu::ImageId color;        ///< f32x4: the frame to merge, noisy or smoothed
  /// f32x2: (variance of the pixel's mean, averaged over channels; 1, or 0 for a non-finite pixel).
  gpu::ImageId variance;
  gpu::History history_color;  ///< f32x4
  /// f32x2: (remaining variance, effective sample count); a count of 0 means no history.
  gpu::History history_stats;
  /// Set if the previous history covers more of the frame than the other images.
  std::optional<SourceWindow> history_window = {};
  std::vector<CarriedInput> carried = {};
};

/// An image of the history (f32x4).
struct CarriedImage {
  gpu::ImageId image;
  Carried kind = Carried::additive;
};

/// The previous history: colour (f32x4) and statistics (f32x2), which cover the window if there is one.
struct WarpInputs {
  gpu::ImageId color;
  gpu::ImageId stats;
  std::optional<SourceWindow> window = {};
  std::vector<CarriedImage> carried = {};
  int offset_limit_px = 0;  ///< largest component of the offsets
};

/// The history warped to the target's pixels.
struct WarpedHistory {
  gpu::ImageId color;                      ///< f32x4
  gpu::ImageId stats;                      ///< f32x2
  std::vector<gpu::ImageId> carried = {};  ///< f32x4
};

/// Reads the previous history at the offsets (f32x2, full resolution).
WarpedHistory add_warp_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                              const WarpInputs& history, gpu::ImageId offset);

/// Inputs of the merge for the noisy layers of a new frame; `history` has FilterTask::kNoisyLayers images.
std::vector<CarriedInput> add_noisy_layers(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& noisy,
                                           std::span<const gpu::History> history);

struct MergeOutputs {
  gpu::ImageId warped_color;                 ///< f32x4: the history warped to the new frame
  gpu::ImageId warped_stats;                 ///< f32x2, as the history's
  std::vector<gpu::ImageId> warped_carried;  ///< f32x4
  /// f32x4: rejected share of the history; its squared bias (in mask mode, the variance that stands for the
  /// rejected share), to be added to the variance of warped_stats if the warped history is used as a
  /// prediction of the new frame; weight of the new sample; 0.
  gpu::ImageId decision;
};

/// Merges the new frame with the warped history into history_color.next and history_stats.next, and carried
/// images with the same weights into their histories.
MergeOutputs add_merge_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                              const MergeInputs& inputs, const Alignment& alignment);

}  // namespace becalm::filter
