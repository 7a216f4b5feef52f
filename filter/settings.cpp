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
struct PyramidShape {};
struct MergeWeights {};
template <class Enum>
struct Named {
  Enum Settings::*member;
  std::span<const std::string_view> names;  ///< of the enum's values in order, from 0
};
using Field = std::variant<IntRange, IntChoice, IntList, PyramidShape, MergeWeights, Named<Distance>,
                           Named<MotionUse>, Named<Resample>, Named<Smooth>, Named<Directions>>;

constexpr std::array<std::string_view, 4> kDistanceNames{"l2", "l1", "log_l1", "log_l1_centered"};
constexpr std::array<std::string_view, 3> kSmoothNames{"none", "frames", "merged"};
constexpr std::array<std::string_view, 2> kDirectionsNames{"forward", "both"};
constexpr std::array<std::string_view, 3> kMotionNames{"none", "guide", "override"};
constexpr std::array<std::string_view, 2> kResampleNames{"bilinear", "catmull_rom"};
constexpr std::string_view kVarianceMerge = "variance";
constexpr std::string_view kMaskMerge = "mask";
constexpr int kMostLevels = 12;
constexpr MaskWeights kLargestMask{.alpha = 1.0f, .kappa = 1000.0f, .eta = 100.0f};

struct Row {
  SettingInfo info;
  Field field;
};

const Row kTable[] = {
    {{"match_downsample", "1, 2 or 4",
      "matching runs on images so many times smaller: faster, and steadier under noise"},
     IntChoice{&Settings::match_downsample, {1, 2, 4}}},
    {{"pyramid", "FACTOR or FACTORxLEVELS, such as 2 or 4x4",
      "each level is FACTOR (2 or 4) times smaller than the one before; LEVELS 1..12, by default as many as "
      "the image size asks for"},
     PyramidShape{}},
    {{"blur_radius", "integers 0..10 joined by commas",
      "patch radius of each level, the finest first; the last serves all coarser levels"},
     IntList{&Settings::blur_radius, 0, 10}},
    {{"distance", "l2, l1, log_l1 or log_l1_centered",
      "pixel distance of the matching; all but the last are there to compare with the paper"},
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
    {{"merge", "variance, mask or mask:ALPHA,KAPPA,ETA",
      "variance: least expected squared error; mask: as published, the history weighs ALPHA (0..1) at most, "
      "and less where KAPPA (0..1000) times the patch distance exceeds ETA (0..100); default mask:0.9,2,2"},
     MergeWeights{}},
    {{"patch_radius", "integer 1..8", "variance mode: radius of the patches that weights are estimated from"},
     IntRange{&Settings::patch_radius, 1, 8}},
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

/// The numbers of a text that `separator` joins, each within its range; nothing if the text is anything else.
template <class Number>
std::optional<std::vector<Number>> parse_list(std::string_view text, char separator, Number lowest,
                                              Number highest) {
  std::vector<Number> values;
  while (true) {
    const auto end = text.find(separator);
    const auto value = parse<Number>(text.substr(0, end));
    // The comparison is false for NaN too.
    if (!value || !(*value >= lowest && *value <= highest)) return std::nullopt;
    values.push_back(*value);
    if (end == std::string_view::npos) return values;
    text.remove_prefix(end + 1);
  }
}

bool assign_pyramid(Settings& settings, std::string_view text) {
  const auto numbers = parse_list(text, 'x', 1, kMostLevels);
  if (!numbers || numbers->size() > 2) return false;
  const int factor = numbers->front();
  if (factor != 2 && factor != 4) return false;
  settings.pyramid = {.factor = factor, .levels = numbers->size() == 2 ? numbers->back() : 0};
  return true;
}

bool assign_merge(Settings& settings, std::string_view text) {
  if (text == kVarianceMerge || text == kMaskMerge) {
    settings.merge = text == kMaskMerge ? MergeMode::mask : MergeMode::variance;
    settings.mask = {};
    return true;
  }
  if (!text.starts_with(kMaskMerge) || !text.substr(kMaskMerge.size()).starts_with(':')) return false;
  const auto numbers = parse_list(text.substr(kMaskMerge.size() + 1), ',', 0.0f, kLargestMask.kappa);
  if (!numbers || numbers->size() != 3) return false;
  const MaskWeights mask{.alpha = (*numbers)[0], .kappa = (*numbers)[1], .eta = (*numbers)[2]};
  if (mask.alpha > kLargestMask.alpha || mask.eta > kLargestMask.eta) return false;
  settings.merge = MergeMode::mask;
  settings.mask = mask;
  return true;
}

/// False if the text is not a value of the field.
bool assign(Settings& settings, const Field& field, std::string_view text) {
  return std::visit(Overloaded{
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
                        [&](const IntList& f) {
                          auto values = parse_list(text, ',', f.lowest, f.highest);
                          if (values) settings.*f.member = std::move(*values);
                          return values.has_value();
                        },
                        [&](const PyramidShape&) { return assign_pyramid(settings, text); },
                        [&](const MergeWeights&) { return assign_merge(settings, text); },
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
          [&](const PyramidShape&) {
            const auto [factor, levels] = settings.pyramid;
            return levels == 0 ? fmt::format("{}", factor) : fmt::format("{}x{}", factor, levels);
          },
          [&](const MergeWeights&) {
            const MaskWeights& mask = settings.mask;
            return settings.merge == MergeMode::variance
                       ? std::string(kVarianceMerge)
                       : fmt::format("{}:{},{},{}", kMaskMerge, mask.alpha, mask.kappa, mask.eta);
          },
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
    settings.pyramid = {.factor = 4, .levels = 4};
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
