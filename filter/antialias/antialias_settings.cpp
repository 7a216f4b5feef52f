#include "filter/antialias/antialias_settings.h"

#include <array>

#include "filter/setting_rows.h"
#include "frame/error.h"

namespace becalm::filter {
namespace {

constexpr std::array<std::string_view, 2> kAntialiasResampleNames{"catmull_rom", "spline"};
constexpr std::array<std::string_view, 3> kReprojectNames{"search", "vectors", "known"};
constexpr std::array<std::string_view, 3> kAccumulateNames{"exponential", "gain", "variance"};
constexpr std::array<std::string_view, 2> kRectifyNames{"none", "clamp"};
constexpr std::array<std::string_view, 2> kBoundsNames{"extremes", "deviation"};
constexpr std::array<std::string_view, 2> kSwitchNames{"no", "yes"};

const SettingRow<AntialiasSettings> kAntialiasTable[] = {
    {{"reproject", "search, vectors or known",
      "what brings the history to a frame: the aligner's search; motion vectors; or vectors where known, "
      "else the search"},
     name_field(&AntialiasSettings::reproject, kReprojectNames)},
    {{"refine_levels", "integer 0..12",
      "subpixel refinement of the search on so many of its finest levels; without it slow motion stutters"},
     number_field(&AntialiasSettings::refine_levels, 0, 12)},
    {{"directions", "forward or both", "history of the frames before alone, or of those after as well"},
     name_field(&AntialiasSettings::directions, kDirectionsNames)},
    {{"resample", "catmull_rom or spline", "filter by which the history is read between its pixels"},
     name_field(&AntialiasSettings::resample, kAntialiasResampleNames, Resample::catmull_rom)},
    {{"accumulate", "exponential, gain or variance",
      "weight of a new sample: 0.1; by the 3x3 pixels around it (Philippi et al. 2022); or by their "
      "variance, 1/n of it for a history of n frames"},
     name_field(&AntialiasSettings::accumulate, kAccumulateNames)},
    {{"rectify", "none or clamp", "clamps the history to the bounds of the frame's 3x3 pixels"},
     name_field(&AntialiasSettings::rectify, kRectifyNames)},
    {{"bounds", "extremes or deviation",
      "of those pixels: least and most, or a standard deviation on both sides of the mean"},
     name_field(&AntialiasSettings::bounds, kBoundsNames)},
    {{"mask", "no or yes", "averages only where the aligner's patches differ (needs a search)"},
     switch_field(&AntialiasSettings::mask, kSwitchNames)},
    {{"reconstruct", "no or yes",
      "makes each pixel of a jittered frame of all samples under its filter, whose places are known; with "
      "--scale or --checkerboard always"},
     switch_field(&AntialiasSettings::reconstruct, kSwitchNames)},
};

}  // namespace

std::span<const SettingInfo> antialias_settings_table() {
  static const std::vector<SettingInfo> infos = infos_of(kAntialiasTable);
  return infos;
}

AntialiasSettings antialias_preset(std::string_view name) {
  AntialiasSettings settings;
  if (name == "best") return settings;
  settings.directions = Directions::forward;
  if (name == "forward") return settings;
  settings.resample = Resample::catmull_rom;
  settings.reconstruct = false;
  settings.reproject = Reproject::vectors;
  if (name == "clamping") {
    // Survey of Yang et al. 2020, sections 3.3 and 4.2, with the weight that Philippi et al. call usual.
    settings.accumulate = Accumulate::exponential;
    settings.rectify = Rectify::clamp;
    settings.bounds = Bounds::extremes;
  } else if (name == "gain") {
    // Philippi et al. 2022, section 4.2, which rectifies nothing.
    settings.accumulate = Accumulate::gain;
  } else if (name == "paper") {
    // Hanika et al. 2021, section 4.
    settings.reproject = Reproject::search;
    settings.refine_levels = 2;
    settings.accumulate = Accumulate::exponential;
    settings.rectify = Rectify::clamp;
    settings.mask = true;
  } else {
    throw Error(ExitStatus::usage,
                fmt::format("preset '{}': expected one of {}", name, fmt::join(kAntialiasPresets, ", ")));
  }
  return settings;
}

void set(AntialiasSettings& settings, std::string_view assignment) {
  assign_setting(kAntialiasTable, settings, assignment);
}

std::string to_string(const AntialiasSettings& settings) {
  return settings_text(kAntialiasTable, settings);
}

}  // namespace becalm::filter
