#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::filter {

/// The pixel distance of the aligner (Hanika et al. 2021, eq. 2-5). The values are those of
/// shaders/lib/distance.glsl.
enum class Distance { l2 = 0, l1 = 1, log_l1 = 2, log_l1_centered = 3 };

/// Use of the `motion` AOV: none; a candidate start offset at one level of the search; or the offset itself
/// in pixels that have motion.
enum class MotionUse { none, guide, override_offset };

/// The filter that reads the history between its pixels; the spline is for temporal antialiasing. Kernels
/// read the values (shaders/lib/resample.glsl).
enum class Resample { bilinear = 0, catmull_rom = 1, spline = 2 };

/// The frames that contribute to an output: the frames up to it, with unbounded history; or also the frames
/// after it, within segments.
enum class Directions { forward, both };

/// What is smoothed: nothing; each frame before it is matched and merged; or each frame, to obtain the merge
/// weights, and then the noisy frames that were merged with them.
enum class Smooth { none, frames, merged };

/// How the merge weighs the history against the new frame: by the patch distance (Hanika et al. 2021, section
/// 3.2), or for the least expected squared error.
enum class MergeMode { mask, variance };

/// Each level of the matching pyramid is `factor` times smaller than the one before.
struct Pyramid {
  int factor = 2;
  int levels = 0;  ///< 0: as many as the image size asks for
};

/// The filter's settings. One table (settings.cpp) holds their names, ranges and help texts; `--set
/// KEY=VALUE`, the help and the output files' `becalm:settings` attribute use it.
struct Settings {
  int match_downsample = 2;
  Pyramid pyramid;
  std::vector<int> blur_radius = {6};
  Distance distance = Distance::log_l1_centered;
  int refine_levels = 1;
  bool guides = true;
  MotionUse motion = MotionUse::none;

  Resample resample = Resample::catmull_rom;
  Smooth smooth = Smooth::merged;
  bool smooth_albedo = true;
  Directions directions = Directions::both;
  MergeMode merge = MergeMode::variance;
  int patch_radius = 1;
};

/// One row of the settings table.
struct SettingInfo {
  std::string_view key;
  std::string_view type;  ///< accepted values, such as "integer 1..8"
  std::string_view help;
};
std::span<const SettingInfo> settings_table();

/// Names of the presets, from the fastest; `paper` is the method as published.
inline constexpr std::array<std::string_view, 4> kPresets{"draft", "balanced", "final", "paper"};

/// The preset of this name. Throws Error(usage) for another.
Settings preset(std::string_view name);

/// Applies one `KEY=VALUE`. Throws Error(usage) naming the key, the value and the range.
void set(Settings& settings, std::string_view assignment);

/// All settings as `key=value` pairs joined by spaces, in table order: equal text means equal settings.
std::string to_string(const Settings& settings);

}  // namespace becalm::filter
