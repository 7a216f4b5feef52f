#include "frame/io/layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <functional>

#include "frame/error.h"
#include "frame/io/printable.h"

namespace becalm::io {
namespace {

/// One row: a layer of this name is this AOV. Rows of one AOV stand in the order of preference. Names are
/// lower case, as are those they are compared with; a view layer's or a scene's name and a dot may stand
/// before them. A new renderer is more rows.
struct Alias {
  Aov aov;
  std::string_view layer;
  float y_scale = 1.0f;
};

constexpr Alias kAliases[] = {
    {Aov::beauty, ""},
    {Aov::beauty, "combined"},
    {Aov::beauty, "noisy image"},
    {Aov::variance, "variance"},
    {Aov::albedo, "denoising albedo"},
    {Aov::albedo, "albedo"},
    {Aov::normal, "denoising normal"},
    {Aov::normal, "normal"},
    {Aov::depth, "depth"},
    {Aov::depth, "denoising depth"},
    {Aov::depth, ""},
    {Aov::motion, "motion"},
    // Cycles: XY = position in the previous frame - position in this one, in pixels, y counted upwards.
    {Aov::motion, "vector", -1.0f},
    {Aov::half_a, "half_a"},
    {Aov::half_b, "half_b"},
    {Aov::direct, "direct"},
    {Aov::indirect, "indirect"},
    {Aov::object_id, "object_id"},
    {Aov::material_id, "material_id"},
    {Aov::flow, "flow"},
    {Aov::error_mask, "error_mask"},
    {Aov::sample_count, "sample_count"},
    {Aov::bias, "bias"},
    {Aov::gain, "gain"},
    {Aov::rejected_by, "rejected_by"},
    {Aov::residual, "residual"},
    {Aov::accumulated, "accumulated"},
    {Aov::accumulated_variance, "accumulated_variance"},
};

/// Blender writes what its compositor made of the picture as a layer of this scope. Its noise is no longer
/// the renderer's, so it is the last choice.
constexpr std::string_view kCompositeScope = "composite";

/// Ways to spell an AOV's channels, in the order of kAovTable's letters.
struct Spelling {
  std::string_view table_channels;
  std::string_view letters;
};

constexpr Spelling kSpellings[] = {
    {"RGBA", "rgba"}, {"RGB", "rgb"}, {"XYZ", "xyz"}, {"XYZ", "rgb"}, {"Z", "z"}, {"Z", "v"}, {"Z", "y"},
    {"Z", "r"},       {"XY", "xy"},   {"XY", "rg"},   {"Y", "y"},     {"Y", "v"}, {"Y", "r"},
};

struct SpelledLetter {
  std::string_view word;
  char letter;
};

constexpr SpelledLetter kSpelledLetters[] = {{"red", 'r'}, {"green", 'g'}, {"blue", 'b'}, {"alpha", 'a'}};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// The channels of one layer of one part, by lower-case letter.
struct Layer {
  int part = 0;
  std::string name;  ///< lower case; empty for bare channels
  std::map<char, std::string> channels;
};

/// A layer's name and the channel's letter (or 0) in a channel's name. Layer names may hold dots and spaces,
/// so only the last dot counts.
std::pair<std::string, char> split_channel(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  const std::string suffix =
      lower(dot == std::string::npos ? channel : std::string_view(channel).substr(dot + 1));
  std::string layer = dot == std::string::npos ? "" : lower(std::string_view(channel).substr(0, dot));
  if (suffix.size() == 1) return {std::move(layer), suffix[0]};
  for (const SpelledLetter& spelled : kSpelledLetters) {
    if (spelled.word == suffix) return {std::move(layer), spelled.letter};
  }
  return {lower(channel), '\0'};
}

/// Layers in the order in which their first channels stand in the file. A channel without a letter is a layer
/// of its own, so that `depth` alone is found as `depth.Z` is.
std::vector<Layer> collect_layers(const std::vector<std::vector<std::string>>& part_channels) {
  std::vector<Layer> layers;
  for (std::size_t part = 0; part < part_channels.size(); ++part) {
    for (const std::string& channel : part_channels[part]) {
      const auto [name, letter] = split_channel(channel);
      auto layer = std::find_if(layers.begin(), layers.end(), [&, &name = name](const Layer& other) {
        return other.part == static_cast<int>(part) && other.name == name;
      });
      if (layer == layers.end()) layer = layers.insert(layer, Layer{static_cast<int>(part), name, {}});
      layer->channels.emplace(letter, channel);
    }
  }
  return layers;
}

/// The layer's channels as those of the AOV, if it has them all; alpha alone may be missing.
std::optional<LayerSource> channels_as(const Layer& layer, Aov aov) {
  const bool single = channel_count(aov) == 1;
  if (const auto lone = layer.channels.find('\0'); single && lone != layer.channels.end()) {
    return LayerSource{layer.part, {lone->second}};
  }
  for (const Spelling& spelling : kSpellings) {
    if (spelling.table_channels != info(aov).channels) continue;
    // Bare letters name a beauty's colours, and of the rest only Z's meaning is certain.
    if (layer.name.empty() && aov == Aov::depth && spelling.letters != "z") continue;
    LayerSource source{layer.part, {}};
    for (char letter : spelling.letters) {
      const auto channel = layer.channels.find(letter);
      if (channel != layer.channels.end()) {
        source.channels.push_back(channel->second);
      } else if (letter == 'a') {
        source.channels.emplace_back();
      }
    }
    if (source.channels.size() == spelling.letters.size()) return source;
  }
  return std::nullopt;
}

/// What stands before the alias in the layer's name, without the dot ("" for nothing), or nullopt where the
/// layer is not of that alias.
std::optional<std::string_view> scope_before(std::string_view layer, std::string_view alias) {
  if (layer == alias) return "";
  if (alias.empty() || layer.size() <= alias.size() + 1 || !layer.ends_with(alias)) return std::nullopt;
  const std::size_t dot = layer.size() - alias.size() - 1;
  if (layer[dot] != '.') return std::nullopt;
  return layer.substr(0, dot);
}

/// The view layer's or scene's name before a layer's own name, such as `viewlayer` of `viewlayer.combined`.
std::string_view scope_of(std::string_view layer) {
  const std::size_t dot = layer.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : layer.substr(0, dot);
}

struct Found {
  LayerSource source;
  std::string scope;
};

/// The first layer that a row of the AOV names and whose scope is accepted.
std::optional<Found> find_by_alias(const std::vector<Layer>& layers, Aov aov, auto accept_scope) {
  for (const Alias& alias : kAliases) {
    if (alias.aov != aov) continue;
    for (const Layer& layer : layers) {
      const std::optional<std::string_view> scope = scope_before(layer.name, alias.layer);
      if (!scope || !accept_scope(*scope)) continue;
      if (std::optional<LayerSource> source = channels_as(layer, aov)) {
        source->y_scale = alias.y_scale;
        return Found{std::move(*source), std::string(*scope)};
      }
    }
  }
  return std::nullopt;
}

/// The convention of the row that names this layer, if one does; becalm's own otherwise.
float y_scale_of(Aov aov, std::string_view layer) {
  for (const Alias& alias : kAliases) {
    if (alias.aov == aov && scope_before(layer, alias.layer)) return alias.y_scale;
  }
  return 1.0f;
}

std::optional<Found> find_override(const std::vector<Layer>& layers, Aov aov, const std::string& wanted) {
  const std::string name = lower(wanted);
  for (const bool whole : {true, false}) {
    for (const Layer& layer : layers) {
      const std::optional<std::string_view> scope = scope_before(layer.name, name);
      if (!scope || (whole && !scope->empty())) continue;
      if (std::optional<LayerSource> source = channels_as(layer, aov)) {
        source->y_scale = y_scale_of(aov, layer.name);
        return Found{std::move(*source), std::string(scope_of(layer.name))};
      }
    }
  }
  if (channel_count(aov) > 1) return std::nullopt;
  for (const Layer& layer : layers) {
    for (const auto& [letter, channel] : layer.channels) {
      if (lower(channel) == name) return Found{{layer.part, {channel}}, ""};
    }
  }
  return std::nullopt;
}

std::optional<Found> find_beauty(const std::vector<Layer>& layers) {
  const auto is_composite = [](std::string_view scope) { return scope == kCompositeScope; };
  if (auto found = find_by_alias(layers, Aov::beauty, std::not_fn(is_composite))) return found;
  return find_by_alias(layers, Aov::beauty, is_composite);
}

/// The channels in one line, cut short where there are very many.
std::string list_channels(const std::vector<std::vector<std::string>>& part_channels) {
  constexpr std::size_t most_listed = 60;
  constexpr std::size_t longest = 1500;
  std::vector<std::string_view> names;
  for (const auto& channels : part_channels) names.insert(names.end(), channels.begin(), channels.end());
  if (names.empty()) return "none";
  std::string text;
  std::size_t listed = 0;
  for (; listed < std::min(names.size(), most_listed) && text.size() < longest; ++listed) {
    text += (listed == 0 ? "" : ", ") + printable(names[listed]);
  }
  if (listed < names.size()) text += fmt::format(" and {} more", names.size() - listed);
  return text;
}

}  // namespace

LayerOverrides parse_layer_overrides(std::string_view text) {
  LayerOverrides overrides;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
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
    overrides[*aov] = item.substr(equals + 1);
  }
  return overrides;
}

LayerMap find_layers(const std::string& file, const std::vector<std::vector<std::string>>& part_channels,
                     const LayerOverrides& overrides) {
  const std::vector<Layer> layers = collect_layers(part_channels);
  LayerMap map;
  const auto set = [&](Aov aov, LayerSource source) {
    map[static_cast<std::size_t>(aov)] = std::move(source);
  };

  std::optional<std::string> beauty_scope;
  for (const auto& [aov, name] : overrides) {
    std::optional<Found> found = find_override(layers, aov, name);
    if (!found) {
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: no layer '{}' with channels for {} ({}); channels found: {}", file, name,
                              aov == Aov::beauty ? "beauty" : info(aov).name, info(aov).channels,
                              list_channels(part_channels)));
    }
    if (aov == Aov::beauty) beauty_scope = found->scope;
    set(aov, std::move(found->source));
  }
  if (!beauty_scope) {
    std::optional<Found> beauty = find_beauty(layers);
    if (!beauty) {
      throw Error(
          ExitStatus::bad_input,
          fmt::format(
              "{}: no colour: expected channels R G B or LAYER.Combined.R G B, or --layers beauty=NAME; "
              "channels found: {}",
              file, list_channels(part_channels)));
    }
    beauty_scope = beauty->scope;
    set(Aov::beauty, std::move(beauty->source));
  }

  for (const AovInfo& entry : kAovTable) {
    if (map[static_cast<std::size_t>(entry.aov)]) continue;
    const auto in_scope = [&](std::string_view scope) { return scope == *beauty_scope; };
    const auto in_none = [&](std::string_view scope) { return scope.empty(); };
    // A bare beauty tells no view layer, so any may go with it.
    const auto in_any = [&](std::string_view) { return beauty_scope->empty(); };
    std::optional<Found> found = find_by_alias(layers, entry.aov, in_scope);
    if (!found) found = find_by_alias(layers, entry.aov, in_none);
    if (!found) found = find_by_alias(layers, entry.aov, in_any);
    if (found) set(entry.aov, std::move(found->source));
  }
  return map;
}

}  // namespace becalm::io
