#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "frame/error.h"
#include "frame/io/channel_layers.h"
#include "frame/io/layers.h"

namespace becalm::io {
namespace {

/// Takes the text before the first comma off its front.
std::string_view take_item(std::string_view& text) {
  const std::size_t comma = text.find(',');
  const std::string_view item = text.substr(0, comma);
  text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
  return item;
}

float parse_scale(std::string_view item, std::string_view text) {
  float scale = 0.0f;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), scale);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(scale) || scale == 0.0f) {
    throw Error(ExitStatus::usage,
                fmt::format("motion '{}': expected scale=S with a number other than 0", item));
  }
  return scale;
}

}  // namespace

LayerOverrides parse_layer_overrides(std::string_view text) {
  LayerOverrides overrides;
  while (!text.empty()) {
    const std::string_view item = take_item(text);
    const std::size_t equals = item.find('=');
    const std::string_view key = item.substr(0, equals);
    const std::optional<Aov> aov = find_aov(key);
    if (!aov) {
      std::string known = "beauty";
      for (const AovInfo& entry : kAovTable) {
        if (!entry.name.empty()) known += fmt::format(", {}", entry.name);
      }
      throw Error(ExitStatus::usage,
                  fmt::format("layers '{}': no AOV is called '{}'; there are {}", item, key, known));
    }
    if (equals == std::string_view::npos || equals + 1 == item.size()) {
      throw Error(ExitStatus::usage, fmt::format("layers '{}': no layer name; expected {}=NAME", item, key));
    }
    const std::string_view name = item.substr(equals + 1);
    if (*aov == Aov::beauty && lower(name) == "none") {
      throw Error(ExitStatus::usage, fmt::format("layers '{}': the beauty cannot be left out", item));
    }
    overrides[*aov] = name;
  }
  return overrides;
}

MotionChange parse_motion_change(std::string_view text) {
  MotionChange change;
  while (!text.empty()) {
    const std::string_view item = take_item(text);
    constexpr std::string_view scale = "scale=";
    if (item == "flip-x") {
      change.scale[0] = -change.scale[0];
    } else if (item == "flip-y") {
      change.scale[1] = -change.scale[1];
    } else if (item == "swap") {
      change.swap = true;
    } else if (item.starts_with(scale)) {
      const float factor = parse_scale(item, item.substr(scale.size()));
      for (float& axis : change.scale) axis *= factor;
    } else {
      throw Error(ExitStatus::usage,
                  fmt::format("motion '{}': expected some of flip-x, flip-y, scale=S and swap", item));
    }
  }
  return change;
}

}  // namespace becalm::io
