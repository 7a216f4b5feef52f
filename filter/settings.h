#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::filter {

/// The pixel distance of the aligner (Hanika et al. 2021, eq. 2-5). The values are those of
/// shaders/lib/distance.glsl.
enum class Distance { l2 = 0, l1 = 1, log_l1 = 2, log_l1_centered = 3 };

/// What known motion (the `motion` AOV) is for: nothing, a candidate where one level of the search starts
/// from, or the offset itself wherever it is known.
enum class MotionUse { none, guide, override_offset };

/// The filter by which the history is read between its pixels. The values are those of
/// shaders/lib/resample.glsl.
enum class Resample { bilinear = 0, catmull_rom = 1, o_moms = 2 };

/// Which frames an output is made from: those up to it, of unbounded history; or those after it as well,
/// within segments.
enum class Directions { forward, both };

/// What is smoothed: nothing; each frame before it is matched and merged; or each frame, so that the weights
/// of the merge are known, and then the noisy frames that were merged with them.
enum class Smooth { none, frames, merged };

/// How the merge weighs history against the new frame.
enum class MergeMode { mask, variance };

/// What a user may set of the filter. One table (settings.cpp) holds names, ranges and help texts;
/// `--set KEY=VALUE`, the help and the files' `becalm:settings` attribute are made from it.
struct Settings {
  int match_downsample = 2;
  int pyramid_factor = 2;
  int pyramid_levels = 0;
  std::vector<int> blur_radius = {1, 2};
  Distance distance = Distance::log_l1_centered;
  int refine_levels = 12;
  int prefilter = 1;
  int guides = 1;
  MotionUse motion = MotionUse::none;

  Resample resample = Resample::catmull_rom;
  Smooth smooth = Smooth::merged;
  Directions directions = Directions::both;
  MergeMode merge = MergeMode::variance;
  float mask_alpha = 0.9f;
  float mask_kappa = 2.0f;
  float mask_eta = 2.0f;
  int patch_radius = 1;
  int additive = 1;
  int alpha = 0;
};

/// One row of the settings table.
struct SettingInfo {
  std::string_view key;
  std::string_view type;  ///< what a value looks like: "integer 1..8", "one of l2, l1, ..."
  std::string_view help;
};
std::span<const SettingInfo> settings_table();

/// The named preset (draft, balanced, final, paper). Throws Error(usage) for another name.
Settings preset(std::string_view name);

/// Applies one `KEY=VALUE`. Throws Error(usage) naming the key, the value and the range.
void set(Settings& settings, std::string_view assignment);

/// All settings as `key=value` pairs joined by spaces, in table order: equal text means equal settings.
std::string to_string(const Settings& settings);

}  // namespace becalm::filter
