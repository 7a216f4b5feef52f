#include "filter/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "filter/setting_rows.h"
#include "frame/error.h"

namespace becalm::filter {
namespace {

constexpr std::array<std::string_view, 4> kDistanceNames{"l2", "l1", "log_l1", "log_l1_centered"};
constexpr std::array<std::string_view, 3> kSmoothNames{"none", "frames", "merged"};
constexpr std::array<std::string_view, 2> kResampleNames{"bilinear", "catmull_rom"};
constexpr std::array<std::string_view, 3> kMotionNames{"none", "guide", "override"};
constexpr std::array<std::string_view, 2> kMergeNames{"mask", "variance"};
constexpr int kMostLevels = 12;

SettingField<Settings> match_downsample_field() {
  return {.assign =
              [](Settings& settings, std::string_view text) {
                const auto value = parse_number(text);
                if (value != 1 && value != 2 && value != 4) return false;
                settings.match_downsample = *value;
                return true;
              },
          .text = [](const Settings& settings) { return fmt::format("{}", settings.match_downsample); }};
}

SettingField<Settings> blur_radius_field() {
  return {
      .assign =
          [](Settings& settings, std::string_view text) {
            auto values = parse_numbers(text, ',', 0, 10);
            if (values) settings.blur_radius = std::move(*values);
            return values.has_value();
          },
      .text =
          [](const Settings& settings) { return fmt::format("{}", fmt::join(settings.blur_radius, ",")); }};
}

bool assign_pyramid(Settings& settings, std::string_view text) {
  const auto numbers = parse_numbers(text, 'x', 1, kMostLevels);
  if (!numbers || numbers->size() > 2) return false;
  const int factor = numbers->front();
  if (factor != 2 && factor != 4) return false;
  settings.pyramid = {.factor = factor, .levels = numbers->size() == 2 ? numbers->back() : 0};
  return true;
}

SettingField<Settings> pyramid_field() {
  return {.assign = assign_pyramid, .text = [](const Settings& settings) {
            const auto [factor, levels] = settings.pyramid;
            return levels == 0 ? fmt::format("{}", factor) : fmt::format("{}x{}", factor, levels);
          }};
}

const SettingRow<Settings> kTable[] = {
    {{"match_downsample", "1, 2 or 4",
      "matching runs on images so many times smaller: faster, and steadier under noise"},
     match_downsample_field()},
    {{"pyramid", "FACTOR or FACTORxLEVELS, such as 2 or 4x4",
      "each level is FACTOR (2 or 4) times smaller than the one before; LEVELS 1..12, by default as many as "
      "the image size asks for"},
     pyramid_field()},
    {{"blur_radius", "integers 0..10 joined by commas",
      "patch radius of each level, the finest first; the last serves all coarser levels"},
     blur_radius_field()},
    {{"distance", "l2, l1, log_l1 or log_l1_centered",
      "pixel distance of the matching; all but the last are there to compare with the paper"},
     name_field(&Settings::distance, std::span(kDistanceNames))},
    {{"refine_levels", "integer 0..12", "subpixel refinement on so many of the finest levels"},
     number_field(&Settings::refine_levels, 0, 12)},
    {{"guides", "0 or 1", "1 matches albedo and normal besides the radiance, where frames have them"},
     switch_field(&Settings::guides, {"0", "1"})},
    {{"motion", "none, guide or override",
      "use of the motion AOV: a candidate of the search, unless longer than 256 px and an eighth of the "
      "frame's longer side along an axis; or the offset where known"},
     name_field(&Settings::motion, std::span(kMotionNames))},
    {{"resample", "bilinear or catmull_rom", "filter by which the history is read between its pixels"},
     name_field(&Settings::resample, std::span(kResampleNames))},
    {{"smooth", "none, frames or merged",
      "frames: each frame is smoothed before it is matched and merged; merged: noisy frames are merged with "
      "the weights of smoothed ones, then smoothed"},
     name_field(&Settings::smooth, std::span(kSmoothNames))},
    {{"smooth_albedo", "0 or 1",
      "1 smooths the albedo before radiance is divided by it: of glossy or blurred surfaces many renderers "
      "write it noisy"},
     switch_field(&Settings::smooth_albedo, {"0", "1"})},
    {{"directions", "forward or both",
      "forward: from the frames before alone, as they come; both: from those after as well, within segments"},
     name_field(&Settings::directions, std::span(kDirectionsNames))},
    {{"merge", "variance or mask",
      "variance: least expected squared error; mask: as published, the history weighs less where patches "
      "differ"},
     name_field(&Settings::merge, std::span(kMergeNames))},
    {{"patch_radius", "integer 1..8", "variance mode: radius of the patches that weights are estimated from"},
     number_field(&Settings::patch_radius, 1, 8)},
};

}  // namespace

std::span<const SettingInfo> settings_table() {
  static const std::vector<SettingInfo> infos = infos_of(kTable);
  return infos;
}

Settings preset(std::string_view name) {
  Settings settings;
  settings.motion = MotionUse::guide;
  if (name == "draft") {
    settings.match_downsample = 4;
    settings.smooth = Smooth::frames;
    settings.smooth_albedo = false;
    settings.directions = Directions::forward;
    settings.motion = MotionUse::none;
  } else if (name == "final") {
    settings.match_downsample = 1;
    settings.patch_radius = 2;
  } else if (name == "paper") {
    // Hanika, Tessari and Dachsbacher 2021, sections 3.1 and 3.2.
    settings.match_downsample = 1;
    settings.pyramid = {.factor = 4, .levels = 4};
    settings.blur_radius = {10, 4, 2, 2};
    settings.refine_levels = 2;
    settings.guides = false;
    settings.motion = MotionUse::none;
    settings.resample = Resample::bilinear;
    settings.smooth = Smooth::none;
    settings.smooth_albedo = false;
    settings.directions = Directions::forward;
    settings.merge = MergeMode::mask;
  } else if (name != "balanced") {
    throw Error(ExitStatus::usage,
                fmt::format("preset '{}': expected one of {}", name, fmt::join(kPresets, ", ")));
  }
  return settings;
}

void set(Settings& settings, std::string_view assignment) {
  assign_setting(kTable, settings, assignment);
}

std::string to_string(const Settings& settings) {
  return settings_text(kTable, settings);
}

}  // namespace becalm::filter
