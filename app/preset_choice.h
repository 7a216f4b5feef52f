#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/options.h"
#include "frame/frame.h"

namespace becalm::app {

/// A preset, and what it takes and gives.
struct PresetTime {
  std::string name;
  double seconds = 0.0;  ///< wall time of a frame on this machine
  double error = 1.0;    ///< squared error that it leaves, relative to `final`
};

/// Times draft, balanced and final with the command's settings on a part of a frame, at most 384x216 pixels,
/// and scales them to frames of `pixels`: time is nearly linear in pixels (RESULTS.md, "Time and memory
/// against pixels and frames"). Takes about as long as half a frame of 1920x1080. From the fastest to the
/// most accurate.
std::vector<PresetTime> measure_presets(const FilterOptions& options, const Frame& frame, double pixels);

/// The most accurate that takes at most `seconds` a frame, or the fastest.
const PresetTime& choose_preset(const std::vector<PresetTime>& presets, double seconds);

/// A preset and the samples per pixel that it leaves time for.
struct RenderChoice {
  PresetTime preset;
  int spp = 1;
};
/// The preset of least error for a frame that takes `seconds` altogether, of which each sample per pixel
/// takes `seconds_per_spp`. The filtered error falls as tracer::kFilteredErrorDecay says. Where no preset
/// leaves time for a sample, one sample and the fastest preset.
RenderChoice choose_preset_and_samples(const std::vector<PresetTime>& presets, double seconds,
                                       double seconds_per_spp);

}  // namespace becalm::app
