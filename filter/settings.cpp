#include "filter/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <variant>

#include "frame/error.h"

namespace becalm::filter {
namespace {

struct IntRange {
  int Settings::*member;
  int lowest;
  int highest;
};
struct IntChoice {
  int Settings::*member;
  std::array<int, 3> values;  ///< unused entries repeat the first value
};
struct IntList {
  std::vector<int> Settings::*member;
  int lowest;
  int highest;
};
struct FloatRange {
  float Settings::*member;
  float lowest;
  float highest;
};
template <class Enum>
struct Named {
  Enum Settings::*member;
  std::span<const std::string_view> names;  ///< of the enum's values in order, from 0
};
using Field = std::variant<IntRange, IntChoice, IntList, FloatRange, Named<Distance>, Named<MotionUse>,
                           Named<Resample>, Named<Smooth>, Named<Directions>, Named<MergeMode>>;

constexpr std::array<std::string_view, 4> kDistanceNames{"l2", "l1", "log_l1", "log_l1_centered"};
constexpr std::array<std::string_view, 3> kSmoothNames{"none", "frames", "merged"};
constexpr std::array<std::string_view, 2> kDirectionsNames{"forward", "both"};
constexpr std::array<std::string_view, 3> kMotionNames{"none", "guide", "override"};
constexpr std::array<std::string_view, 2> kResampleNames{"bilinear", "catmull_rom"};
constexpr std::array<std::string_view, 2> kMergeNames{"mask", "variance"};

struct Row {
  SettingInfo info;
  Field field;
};

const Row kTable[] = {
    {{"match_downsample", "1, 2 or 4",
      "matching runs on images so many times smaller: faster, and steadier under noise"},
     IntChoice{&Settings::match_downsample, {1, 2, 4}}},
    {{"pyramid_factor", "2 or 4", "each pyramid level is so many times smaller than the one before"},
     IntChoice{&Settings::pyramid_factor, {2, 4, 2}}},
    {{"pyramid_levels", "integer 0..12", "levels of the pyramid; 0 takes as many as the image size asks for"},
     IntRange{&Settings::pyramid_levels, 0, 12}},
    {{"blur_radius", "integers 0..10 joined by commas",
      "patch radius of each level, the finest first; the last serves all coarser levels"},
     IntList{&Settings::blur_radius, 0, 10}},
    {{"distance", "l2, l1, log_l1 or log_l1_centered", "pixel distance of the matching"},
     Named<Distance>{&Settings::distance, kDistanceNames}},
    {{"refine_levels", "integer 0..12", "subpixel refinement on so many of the finest levels"},
     IntRange{&Settings::refine_levels, 0, 12}},
    {{"prefilter", "integer 0..5",
      "a-trous steps on the radiance that is matched, each reaching twice as far"},
     IntRange{&Settings::prefilter, 0, 5}},
    {{"guides", "0 or 1", "1 matches albedo and normal besides the radiance, where frames have them"},
     IntRange{&Settings::guides, 0, 1}},
    {{"motion", "none, guide or override",
      "use of the motion AOV: a candidate of the search, unless longer than 256 px and an eighth of the "
      "frame's longer side along an axis; or the offset where known"},
     Named<MotionUse>{&Settings::motion, kMotionNames}},
    {{"resample", "bilinear or catmull_rom", "filter by which the history is read between its pixels"},
     Named<Resample>{&Settings::resample, kResampleNames}},
    {{"smooth", "none, frames or merged",
      "frames: each frame is smoothed before it is matched and merged; merged: noisy frames are merged with "
      "the weights of smoothed ones, then smoothed"},
     Named<Smooth>{&Settings::smooth, kSmoothNames}},
    {{"directions", "forward or both",
      "forward: from the frames before alone, as they come; both: from those after as well, within segments"},
     Named<Directions>{&Settings::directions, kDirectionsNames}},
    {{"merge", "mask or variance",
      "mask: weights from the patch distance; variance: least expected squared error"},
     Named<MergeMode>{&Settings::merge, kMergeNames}},
    {{"mask_alpha", "number 0..1", "mask mode: largest weight of the history"},
     FloatRange{&Settings::mask_alpha, 0.0f, 1.0f}},
    {{"mask_kappa", "number 0..1000", "mask mode: scale of the patch distance"},
     FloatRange{&Settings::mask_kappa, 0.0f, 1000.0f}},
    {{"mask_eta", "number 0..100", "mask mode: threshold that noise alone stays below"},
     FloatRange{&Settings::mask_eta, 0.0f, 100.0f}},
    {{"patch_radius", "integer 1..8", "variance mode: radius of the patches that weights are estimated from"},
     IntRange{&Settings::patch_radius, 1, 8}},
    {{"additive", "0 or 1",
      "1 denoises direct, indirect and light groups with the beauty's weights, so that they still add up; 0 "
      "passes them on noisy"},
     IntRange{&Settings::additive, 0, 1}},
    {{"alpha", "0 or 1",
      "0 passes alpha on as it came; 1 denoises it with the beauty's weights where it is as rough as the "
      "noise "
      "of motion blur and depth of field, or as clean hair"},
     IntRange{&Settings::alpha, 0, 1}},
};

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

template <class Number>
std::optional<Number> parse(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool assign_list(std::vector<int>& target, std::string_view text, int lowest, int highest) {
  std::vector<int> values;
  while (true) {
    const auto comma = text.find(',');
    const auto value = parse<int>(text.substr(0, comma));
    if (!value || *value < lowest || *value > highest) return false;
    values.push_back(*value);
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  target = std::move(values);
  return true;
}

/// False if the text is not a value of the field.
bool assign(Settings& settings, const Field& field, std::string_view text) {
  return std::visit(
      Overloaded{
          [&](const IntRange& f) {
            const auto value = parse<int>(text);
            if (!value || *value < f.lowest || *value > f.highest) return false;
            settings.*f.member = *value;
            return true;
          },
          [&](const IntChoice& f) {
            const auto value = parse<int>(text);
            if (!value || std::ranges::find(f.values, *value) == f.values.end()) return false;
            settings.*f.member = *value;
            return true;
          },
          [&](const IntList& f) { return assign_list(settings.*f.member, text, f.lowest, f.highest); },
          [&](const FloatRange& f) {
            const auto value = parse<float>(text);
            // The comparison is false for NaN too.
            if (!value || !(*value >= f.lowest && *value <= f.highest)) return false;
            settings.*f.member = *value;
            return true;
          },
          [&]<class Enum>(const Named<Enum>& f) {
            const auto name = std::ranges::find(f.names, text);
            if (name == f.names.end()) return false;
            settings.*f.member = static_cast<Enum>(name - f.names.begin());
            return true;
          },
      },
      field);
}

std::string value_text(const Settings& settings, const Field& field) {
  return std::visit(
      Overloaded{
          [&](const IntRange& f) { return fmt::format("{}", settings.*f.member); },
          [&](const IntChoice& f) { return fmt::format("{}", settings.*f.member); },
          [&](const IntList& f) { return fmt::format("{}", fmt::join(settings.*f.member, ",")); },
          [&](const FloatRange& f) { return fmt::format("{}", settings.*f.member); },
          [&]<class Enum>(const Named<Enum>& f) {
            return std::string(f.names[static_cast<std::size_t>(settings.*f.member)]);
          },
      },
      field);
}

}  // namespace

std::span<const SettingInfo> settings_table() {
  static const std::vector<SettingInfo> infos = [] {
    std::vector<SettingInfo> result;
    for (const Row& row : kTable) result.push_back(row.info);
    return result;
  }();
  return infos;
}

Settings preset(std::string_view name) {
  Settings settings;
  settings.motion = MotionUse::guide;
  if (name == "draft") {
    settings.match_downsample = 4;
    settings.smooth = Smooth::frames;
    settings.directions = Directions::forward;
    settings.prefilter = 0;
    settings.blur_radius = {5};
    settings.motion = MotionUse::none;
  } else if (name == "final") {
    settings.match_downsample = 1;
    settings.prefilter = 2;
    settings.patch_radius = 2;
  } else if (name == "paper") {
    // Hanika, Tessari and Dachsbacher 2021, sections 3.1 and 3.2.
    settings.match_downsample = 1;
    settings.pyramid_factor = 4;
    settings.pyramid_levels = 4;
    settings.blur_radius = {10, 4, 2, 2};
    settings.refine_levels = 2;
    settings.prefilter = 0;
    settings.guides = 0;
    settings.motion = MotionUse::none;
    settings.resample = Resample::bilinear;
    settings.smooth = Smooth::none;
    settings.directions = Directions::forward;
    settings.merge = MergeMode::mask;
  } else if (name != "balanced") {
    throw Error(ExitStatus::usage,
                fmt::format("preset '{}': expected draft, balanced, final or paper", name));
  }
  return settings;
}

void set(Settings& settings, std::string_view assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    throw Error(ExitStatus::usage, fmt::format("--set '{}': expected KEY=VALUE", assignment));
  }
  const std::string_view key = assignment.substr(0, equals);
  const std::string_view value = assignment.substr(equals + 1);
  for (const Row& row : kTable) {
    if (row.info.key != key) continue;
    if (!assign(settings, row.field, value)) {
      throw Error(ExitStatus::usage,
                  fmt::format("--set {}: value '{}': expected {}", key, value, row.info.type));
    }
    return;
  }
  std::vector<std::string_view> keys;
  for (const Row& row : kTable) keys.push_back(row.info.key);
  throw Error(ExitStatus::usage,
              fmt::format("--set: no setting '{}'; there are {}", key, fmt::join(keys, ", ")));
}

std::string to_string(const Settings& settings) {
  std::string text;
  for (const Row& row : kTable) {
    if (!text.empty()) text += ' ';
    text += fmt::format("{}={}", row.info.key, value_text(settings, row.field));
  }
  return text;
}

}  // namespace becalm::filter
