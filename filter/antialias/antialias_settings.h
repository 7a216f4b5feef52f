#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "filter/settings.h"
#include "frame/scale.h"

namespace becalm::filter {

/// By what the history is brought to the new frame: the aligner's search; motion vectors, and no history
/// where they are unknown; or vectors where known, else the search.
enum class Reproject { search, vectors, known };

/// The weight of the new sample: constant; the gain of Philippi et al. 2022 (eq. 4, 10 and 11); or the gain
/// of eq. 4 with the mean variance v of the new pixels around it, and v / n for a history of n frames. The
/// values are those of shaders/antialias/accumulate.comp.
enum class Accumulate { exponential = 0, gain = 1, variance = 2 };

/// How the history is brought within the bounds of the new frame's 3x3 pixels: not at all; or channel by
/// channel.
enum class Rectify { none, clamp };

/// These bounds, of each channel: the least and the largest value of the samples around, or their mean minus
/// and plus one standard deviation.
enum class Bounds { extremes, deviation };

/// The settings of temporal antialiasing. One table (antialias_settings.cpp) holds their names, ranges and
/// help texts.
struct AntialiasSettings {
  Reproject reproject = Reproject::known;
  int refine_levels = 12;
  Directions directions = Directions::both;
  Resample resample = Resample::spline;
  Accumulate accumulate = Accumulate::variance;
  Rectify rectify = Rectify::none;
  Bounds bounds = Bounds::deviation;
  bool mask = false;
  bool reconstruct = true;

  // Not in the table: properties of the frames and the results rather than of the method.
  Scale scale;                ///< of the results' sides to those of the frames
  bool checkerboard = false;  ///< whether only every other pixel of a frame holds a sample

  bool searches() const { return reproject != Reproject::vectors; }
  bool uses_vectors() const { return reproject != Reproject::search; }
};

std::span<const SettingInfo> antialias_settings_table();

/// Names of the presets; the last three are methods as published, to compare with.
inline constexpr std::array<std::string_view, 5> kAntialiasPresets{"best", "forward", "clamping", "gain",
                                                                   "paper"};

/// The named preset. Throws Error(usage) for another name.
AntialiasSettings antialias_preset(std::string_view name);

/// Applies one `KEY=VALUE`. Throws Error(usage) naming the key, the value and the range.
void set(AntialiasSettings& settings, std::string_view assignment);

/// All settings as `key=value` pairs joined by spaces, in table order: equal text means equal settings.
std::string to_string(const AntialiasSettings& settings);

}  // namespace becalm::filter
