#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::filter {

/// The pixel distance of the aligner (Hanika et al. 2021, eq. 2-5).
enum class Distance { l2, l1, log_l1, log_l1_centered };

/// How the merge weighs history against the new frame.
enum class MergeMode { mask, variance };

/// Everything that steers the filter. Names, ranges, defaults and help texts live in one table (settings.cpp), from which
/// `--set KEY=VALUE`, the help and the files' `becalm:settings` attribute are made.
struct Settings {
  int match_downsample = 2;                 ///< 1, 2 or 4: matching runs on images so much smaller
  int pyramid_factor = 2;                   ///< 2 or 4
  int pyramid_levels = 0;                   ///< 0: as many as the image size asks for
  std::vector<int> blur_radius = {3, 2};    ///< finest level first; the last entry serves all coarser levels
  Distance distance = Distance::log_l1_centered;
  int refine_levels = 2;                    ///< quadric refinement on so many of the finest levels
  float weight_radiance = 1.0f;             ///< matching weights; 0 leaves the channel out
  float weight_albedo = 1.0f;
  float weight_normal = 0.5f;

  MergeMode merge = MergeMode::variance;
  float mask_alpha = 0.9f;                  ///< largest weight of the history in mask mode
  float mask_kappa = 8.0f;
  float mask_eta = 0.4f;
  int mask_level = 0;                       ///< level whose patch distance rejects: 0 finest, 1 first downsampled
  int patch_radius = 3;                     ///< of the statistics that the variance gain is made from
  float max_history = 64.0f;                ///< largest effective sample count
};

/// One row of the settings table.
struct SettingInfo {
  std::string_view key;
  std::string_view type;     ///< for the help: "integer 1..8", "one of l2, l1, ..."
  std::string_view help;
};
std::span<const SettingInfo> settings_table();

/// The named preset (draft, balanced, final). Throws Error(usage) for another name.
Settings preset(std::string_view name);

/// Applies one `KEY=VALUE`. Throws Error(usage) naming the key, the value and the range.
void set(Settings& settings, std::string_view assignment);

/// All settings as `key=value` pairs joined by spaces, in table order: equal text means equal settings.
std::string to_string(const Settings& settings);

}  // namespace becalm::filter
