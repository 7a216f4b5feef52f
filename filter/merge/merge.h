#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filter/align/align.h"
#include "filter/gpu/chain.h"
#include "filter/settings.h"

namespace becalm::filter {

class NoisyInputs;

/// An image (f32x4) of the new frame and the last frame's of the same kind; the latter in the history's
/// window.
struct FramePair {
  gpu::ImageId current;
  gpu::ImageId previous;
};

/// What goes with the beauty's weights into its history.
enum class Carried {
  additive,  ///< an AOV of light, one of those that add up to the radiance
  radiance,  ///< the noisy radiance, its variance in the fourth channel
  features,  ///< no light: the albedo is not divided out of it
};

/// An image that goes with the beauty's weights into its history (f32x4).
struct CarriedInput {
  gpu::ImageId color;  ///< as MergeInputs::color
  gpu::History history;
  Carried kind = Carried::additive;
};

/// Images that the merge works on, all at full resolution and of one size but for the previous history in a
/// window of its own.
struct MergeInputs {
  const NoisyInputs& noisy;  ///< the new frame as it came
  gpu::ImageId color;        ///< f32x4: what is merged, the new frame or that smoothed
  gpu::ImageId variance;     ///< f32x2: (variance of the pixel's mean, averaged over channels; 1, or 0 for a
                             ///< pixel that is not finite)
  gpu::History history_color;  ///< f32x4
  gpu::History
      history_stats;  ///< f32x2: (variance left, effective sample count); a count of 0 means no history
  std::optional<SourceWindow> history_window =
      {};  ///< where the previous history shows more than the new frame
  std::vector<CarriedInput> additive = {};
  std::optional<FramePair> albedo = {};  ///< as WarpInputs::albedo
};

/// An image of the history (f32x4).
struct CarriedImage {
  gpu::ImageId image;
  Carried kind = Carried::additive;
};

/// What is read of the previous history: colour (f32x4) and statistics (f32x2), in the window if there is
/// one.
struct WarpInputs {
  gpu::ImageId color;
  gpu::ImageId stats;
  std::optional<SourceWindow> window = {};
  std::vector<CarriedImage> additive = {};  ///< what goes with the radiance (f32x4)
  std::optional<FramePair> albedo = {};     ///< as pack_albedo gives it, if the history is read without it
};

/// The history where the target's pixels are.
struct WarpedHistory {
  gpu::ImageId color;                       ///< f32x4
  gpu::ImageId stats;                       ///< f32x2
  std::vector<gpu::ImageId> additive = {};  ///< f32x4
};

/// Reads the previous history at the offsets (f32x2, full resolution). Given the albedo, radiance is read
/// without the last frame's and multiplied by the new frame's, as far as that is no noise.
WarpedHistory add_warp_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                              const WarpInputs& history, gpu::ImageId offset);

/// How far around the positions that offsets lead to the history is read.
int resample_margin_px(const Settings& settings);

/// Inputs of the merge for the noisy layers of a new frame, which end in these images:
/// FilterTask::kNoisyLayers.
std::vector<CarriedInput> add_noisy_layers(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& noisy,
                                           std::span<const gpu::History> history);

/// How far from a pixel the merge reads offsets, the new frame and its variance.
int merge_margin_px(const Settings& settings);

struct MergeOutputs {
  gpu::ImageId warped_color;                  ///< f32x4: the history where the new frame's pixels are
  gpu::ImageId warped_stats;                  ///< f32x2, as the history's
  std::vector<gpu::ImageId> warped_additive;  ///< f32x4
  gpu::ImageId decision;  ///< f32x4: share of the history rejected; its squared bias, which is to be added to
                          ///< warped_stats' variance where it predicts the new frame; weight of the new
                          ///< sample; 0
};

/// Merges the new frame with the warped history into history_color.next and history_stats.next, and additive
/// AOVs with the same weights into their histories.
MergeOutputs add_merge_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                              const MergeInputs& inputs, const Alignment& alignment);

}  // namespace becalm::filter
