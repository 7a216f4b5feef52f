#include "frame/io/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "frame/error.h"
#include "frame/io/additive_layers.h"
#include "frame/io/aliases.h"
#include "frame/io/channel_layers.h"
#include "frame/io/part_names.h"
#include "frame/io/printable.h"

namespace becalm::io {
namespace {

/// The scope of the layer that Blender's compositor writes. Its noise may be changed, so it is the last
/// choice for the beauty.
constexpr std::string_view kCompositeScope = "composite";

struct Found {
  LayerSource source;
  std::string scope;
};

/// What stands before the alias in the layer's name, or nullopt where it is not of that alias.
std::optional<std::string_view> scope_of_alias(const ChannelLayer& layer, const Alias& alias) {
  if (!alias.layer.empty()) return scope_before(layer.name(), alias.layer);
  return layer.is_bare() ? std::optional<std::string_view>("") : std::nullopt;
}

void apply_convention(const Alias& alias, LayerSource& source) {
  std::ranges::copy(alias.scale, source.scale.begin());
  source.squared = alias.standard_deviation;
}

/// The layers of one view of a file, and what is found among them.
class LayerFinder {
 public:
  LayerFinder(const std::vector<PartChannels>& parts, const std::string& view)
      : layers_(collect_layers(parts, view)), views_(find_views(parts)) {
    std::map<std::string_view, int> evidence;  // by name: two parts may have one
    int sum = 0;
    for (const ChannelLayer& layer : layers_) evidence[layer.name()] = evidence_of_vray(layer.name());
    // Nuke spells them out, too.
    if (std::ranges::any_of(layers_, &ChannelLayer::spells_colours_out)) sum = kVraysEvidence / 2;
    for (const auto& [name, of_name] : evidence) sum += of_name;
    is_vrays_ = sum >= kVraysEvidence;
  }

  /// In this order: bare channels of a part without a name, layers with a beauty's name, bare channels of a
  /// part that is not named as a summand of the beauty, of any other part that may hold colours, a composite.
  std::optional<Found> find_beauty() const {
    const auto is_composite = [](std::string_view scope) { return scope == kCompositeScope; };
    const auto is_whole_file = [](const ChannelLayer& layer, const Alias& alias) {
      return alias.layer.empty() && layer.part_name.empty();
    };
    const auto is_named = [](const ChannelLayer&, const Alias& alias) { return !alias.layer.empty(); };
    const auto is_colour = [](const ChannelLayer& layer, const Alias& alias) {
      return !alias.layer.empty() || !is_no_colour(layer.part_name);
    };
    const auto is_likely = [&](const ChannelLayer& layer, const Alias& alias) {
      return is_colour(layer, alias) && !is_seldom_beauty(layer.name());
    };
    if (auto found = find_by_alias(Aov::beauty, std::not_fn(is_composite), is_whole_file)) return found;
    if (auto found = find_by_alias(Aov::beauty, std::not_fn(is_composite), is_named)) return found;
    if (auto found = find_by_alias(Aov::beauty, std::not_fn(is_composite), is_likely)) return found;
    return find_by_alias(
        Aov::beauty, [](std::string_view) { return true; }, is_colour);
  }

  /// The first layer that a row of the AOV names and whose scope is accepted.
  std::optional<Found> find_aov(Aov aov, auto accept_scope) const {
    return find_by_alias(aov, accept_scope, [](const ChannelLayer&, const Alias&) { return true; });
  }

  std::optional<Found> find_override(const std::vector<PartChannels>& parts, Aov aov,
                                     const std::string& wanted) const {
    const std::string name = lower(wanted);
    const auto find_in = [&](const std::string& layer, auto accept) {
      std::optional<Found> found = find_named(aov, layer, accept);
      return found ? found : find_named(aov, without_view(layer, views_), accept);
    };
    if (auto found = find_in(name, [](const ChannelLayer&) { return true; })) return found;
    for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1)) {
      const std::string part = name.substr(0, slash);
      const auto is_in_part = [&](const ChannelLayer& layer) {
        return lower(parts[layer.part].name) == part || layer.part_name == without_view(part, views_);
      };
      if (auto found = find_in(name.substr(slash + 1), is_in_part)) return found;
    }
    if (name != "rgba") return std::nullopt;
    return find_named(aov, "", [](const ChannelLayer& layer) { return layer.name().empty(); });
  }

  /// Layers of this part are looked at first from now on.
  void prefer_part(int part) {
    std::stable_partition(layers_.begin(), layers_.end(),
                          [&](const ChannelLayer& layer) { return layer.part == part; });
  }

  /// RenderMan's colour is `Ci.r`, `Ci.g`, `Ci.b`, and its alpha a bare `a` beside it.
  void add_bare_alpha(LayerSource& beauty) const {
    if (!beauty.channels[3].empty()) return;
    for (const ChannelLayer& layer : layers_) {
      const bool is_beside = layer.part == beauty.part && layer.own_name.empty();
      if (is_beside && layer.channels.contains('a') && !layer.channels.contains('r')) {
        beauty.channels[3] = layer.channels.at('a');
      }
    }
  }

 private:
  std::optional<Found> find_by_alias(Aov aov, auto accept_scope, auto accept) const {
    for (const Alias& alias : aliases()) {
      if (alias.aov != aov || (alias.vray_only && !is_vrays_)) continue;
      for (const ChannelLayer& layer : layers_) {
        const std::optional<std::string_view> scope = scope_of_alias(layer, alias);
        if (!scope || !accept_scope(*scope) || !accept(layer, alias)) continue;
        if (std::optional<LayerSource> source = channels_as(layer, aov)) {
          apply_convention(alias, *source);
          return Found{std::move(*source), std::string(*scope)};
        }
      }
    }
    return std::nullopt;
  }

  /// A layer by its whole name, by its end, or one channel; with the convention of the row that names it.
  std::optional<Found> find_named(Aov aov, const std::string& name, auto accept) const {
    for (const bool whole : {true, false}) {
      for (const ChannelLayer& layer : layers_) {
        const std::optional<std::string_view> scope = scope_before(layer.name(), name);
        if (!accept(layer) || !scope || (whole && !scope->empty())) continue;
        if (std::optional<LayerSource> source = channels_as(layer, aov)) {
          for (const Alias& alias : aliases()) {
            if (alias.aov != aov || !scope_of_alias(layer, alias)) continue;
            apply_convention(alias, *source);
            break;
          }
          return Found{std::move(*source), std::string(scope_of(layer.name()))};
        }
      }
    }
    if (channel_count(aov) > 1) return std::nullopt;
    for (const ChannelLayer& layer : layers_) {
      for (const auto& [letter, channel] : layer.channels) {
        const std::string own = lower(channel);
        if (accept(layer) && (own == name || without_view(own, views_) == name))
          return Found{{layer.part, {channel}}, ""};
      }
    }
    return std::nullopt;
  }

  std::vector<ChannelLayer> layers_;
  std::vector<std::string> views_;
  bool is_vrays_ = false;
};

/// What pictures without R G B have in their place: R, G and B in parts of their own, luminance with chroma,
/// or one channel for all.
std::string_view other_colour(const std::vector<PartChannels>& parts) {
  const auto have = [&](std::string_view channel) {
    return std::ranges::any_of(parts, [&](const PartChannels& part) {
      return std::ranges::find(part.channels, channel) != part.channels.end();
    });
  };
  if (have("R") && have("G") && have("B")) return "; R, G and B must lie in one part";
  if (!have("Y")) return "";
  return have("RY") || have("BY") ? "; luminance and chroma must be converted first"
                                  : "; Y alone is one channel, which must be copied to R G B first";
}

/// The channels in one line, as PART/CHANNEL where parts have names; cut short where there are very many.
std::string list_channels(const std::vector<PartChannels>& parts) {
  constexpr std::size_t most_listed = 60;
  constexpr std::size_t longest = 1500;
  std::vector<std::string> names;
  for (const PartChannels& part : parts) {
    for (const std::string& channel : part.channels)
      names.push_back(part.name.empty() ? channel : fmt::format("{}/{}", part.name, channel));
  }
  if (names.empty()) return "none";
  std::string text;
  std::size_t listed = 0;
  for (; listed < std::min(names.size(), most_listed) && text.size() < longest; ++listed) {
    text += (listed == 0 ? "" : ", ") + printable(names[listed]);
  }
  if (listed < names.size()) text += fmt::format(" and {} more", names.size() - listed);
  return text;
}

void change_motion(const MotionChange& change, LayerSource& motion) {
  if (change.swap) std::swap(motion.channels[0], motion.channels[1]);
  for (std::size_t axis = 0; axis < 2; ++axis) motion.scale[axis] *= change.scale[axis];
}

/// pbrt writes the variance of one sample, and in the header how many there were.
void divide_by_samples(int samples, LayerSource& variance) {
  for (float& scale : variance.scale) scale /= static_cast<float>(samples);
}

/// Whether summands of the beauty, which lies in `beauty_part`, may lie in `part`.
bool may_hold_summands(const std::vector<PartChannels>& parts, const std::vector<ChannelLayer>& layers,
                       int beauty_part, int part) {
  if (part == beauty_part) return true;
  if (parts[part].data_window != parts[beauty_part].data_window) return false;
  return std::ranges::none_of(layers, [&](const ChannelLayer& layer) {
    return layer.part == part && layer.is_bare() && !layer.part_name.starts_with(kLightScope) &&
           channels_as(layer, Aov::beauty);
  });
}

/// The layers and parts `light.NAME`, by NAME. Of two of one name, that of the beauty's part is taken.
std::map<std::string, LightSource> find_light_groups(const std::vector<PartChannels>& parts,
                                                     std::vector<ChannelLayer> layers, int beauty_part) {
  std::stable_partition(layers.begin(), layers.end(),
                        [&](const ChannelLayer& layer) { return layer.part == beauty_part; });
  std::map<std::string, LightSource> lights;
  for (const ChannelLayer& layer : layers) {
    const bool is_beauty = layer.part == beauty_part && layer.own_name.empty();
    if (is_beauty || !layer.name().starts_with(kLightScope)) continue;
    if (!may_hold_summands(parts, layers, beauty_part, layer.part)) continue;
    if (std::optional<LayerSource> source = channels_as(layer, Aov::direct)) {
      lights.emplace(layer.title.substr(kLightScope.size()), LightSource{std::move(*source)});
    }
  }
  return lights;
}

void mark_subsampled(const std::vector<PartChannels>& parts, ViewLayers& view) {
  const auto mark = [&](LayerSource& source) {
    source.subsampled = std::ranges::any_of(source.channels, [&](const std::string& channel) {
      return parts[source.part].subsampled.contains(channel);
    });
  };
  for (std::optional<LayerSource>& source : view.layers) {
    if (source) mark(*source);
  }
  for (auto& [name, light] : view.lights) {
    mark(light.layer);
    if (light.colour) mark(*light.colour);
  }
}

/// Gives a light group the whole name of its layer if an additive layer takes the short one.
void keep_light_group(const std::string& name, const LightSource& additive,
                      std::map<std::string, LightSource>& lights) {
  const auto group = lights.find(name);
  if (group == lights.end()) return;
  const LayerSource& layer = group->second.layer;
  if (layer.part == additive.layer.part && layer.channels == additive.layer.channels) return;
  auto node = lights.extract(group);
  node.key() = std::string(kLightScope) + name;
  lights.insert(std::move(node));
}

}  // namespace

std::vector<std::string> find_views(const std::vector<PartChannels>& parts) {
  std::vector<std::string> views;
  const auto add = [&](const std::string& view) {
    if (!view.empty() && std::ranges::find(views, view) == views.end()) views.push_back(view);
  };
  for (const PartChannels& part : parts) {
    add(part.view);
    if (part.view.empty()) std::ranges::for_each(part.multi_view, add);
  }
  if (views.empty()) views.emplace_back();
  return views;
}

std::vector<std::string> find_other_beauties(const std::vector<PartChannels>& parts,
                                             const LayerSource& beauty, const std::string& view) {
  std::map<std::string, std::string> titles;  // by view layer
  std::string taken;
  for (const ChannelLayer& layer : collect_layers(parts, view)) {
    for (const Alias& alias : aliases()) {
      if (alias.aov != Aov::beauty || alias.layer.empty()) continue;
      const std::optional<std::string_view> scope = scope_of_alias(layer, alias);
      const std::optional<LayerSource> source = channels_as(layer, Aov::beauty);
      if (!scope || scope->empty() || *scope == kCompositeScope || !source) continue;
      if (source->part == beauty.part && source->channels.front() == beauty.channels.front()) taken = *scope;
      titles.emplace(*scope, layer.title);
    }
  }
  if (taken.empty()) return {};
  titles.erase(taken);
  std::vector<std::string> others;
  others.reserve(titles.size());
  for (const auto& [scope, title] : titles) others.push_back(title);
  return others;
}

LayerMap find_layers(const std::string& file, const std::vector<PartChannels>& parts,
                     const LayerOptions& options, const std::string& view) {
  LayerFinder finder(parts, view);
  const std::string place = view.empty() ? file : fmt::format("{}: view {}", file, printable(view));
  LayerMap map;
  const auto set = [&](Aov aov, LayerSource source) {
    map[static_cast<std::size_t>(aov)] = std::move(source);
  };

  AovSet left_out;
  std::optional<std::string> beauty_scope;
  for (const auto& [aov, name] : options.layers) {
    if (lower(name) == "none") {
      left_out.set(static_cast<std::size_t>(aov));
      continue;
    }
    std::optional<Found> found = finder.find_override(parts, aov, name);
    if (!found) {
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: no layer '{}' with channels for {} ({}); channels found: {}", place, name,
                              aov == Aov::beauty ? "beauty" : info(aov).name, info(aov).channels,
                              list_channels(parts)));
    }
    if (aov == Aov::beauty) beauty_scope = found->scope;
    set(aov, std::move(found->source));
  }
  if (!beauty_scope) {
    std::optional<Found> beauty = finder.find_beauty();
    if (!beauty) {
      throw Error(
          ExitStatus::bad_input,
          fmt::format(
              "{}: no colour: expected channels R G B or LAYER.Combined.R G B, or --layers beauty=NAME; "
              "channels found: {}{}",
              place, list_channels(parts), other_colour(parts)));
    }
    beauty_scope = beauty->scope;
    set(Aov::beauty, std::move(beauty->source));
  }
  LayerSource& beauty = *map[static_cast<std::size_t>(Aov::beauty)];
  finder.add_bare_alpha(beauty);
  finder.prefer_part(beauty.part);

  for (const AovInfo& entry : kAovTable) {
    if (map[static_cast<std::size_t>(entry.aov)] || contains(left_out, entry.aov)) continue;
    const auto in_scope = [&](std::string_view scope) { return scope == *beauty_scope; };
    const auto in_none = [&](std::string_view scope) { return scope.empty(); };
    // A bare beauty names no view layer, so AOVs of any view layer may go with it.
    const auto in_any = [&](std::string_view) { return beauty_scope->empty(); };
    std::optional<Found> found = finder.find_aov(entry.aov, in_scope);
    if (!found) found = finder.find_aov(entry.aov, in_none);
    if (!found) found = finder.find_aov(entry.aov, in_any);
    if (found) set(entry.aov, std::move(found->source));
  }
  if (auto& motion = map[static_cast<std::size_t>(Aov::motion)]) change_motion(options.motion, *motion);
  if (auto& variance = map[static_cast<std::size_t>(Aov::variance)]) {
    const int samples = parts[variance->part].samples_per_pixel;
    if (samples > 1) divide_by_samples(samples, *variance);
  }
  return map;
}

std::vector<ViewLayers> find_view_layers(const std::string& file, const std::vector<PartChannels>& parts,
                                         const LayerOptions& options) {
  std::vector<std::string> views = find_views(parts);
  const std::string default_view = views.front();
  std::erase_if(views, [&](const std::string& view) {
    return view != default_view && !LayerFinder(parts, view).find_beauty();
  });
  std::vector<ViewLayers> found;
  for (const std::string& view : views) {
    ViewLayers& layers = found.emplace_back(ViewLayers{view, find_layers(file, parts, options, view), {}});
    const int part = layers.layers[static_cast<std::size_t>(Aov::beauty)]->part;
    const std::vector<ChannelLayer> all = collect_layers(parts, view);
    for (const Aov aov : {Aov::direct, Aov::indirect}) {
      std::optional<LayerSource>& source = layers.layers[static_cast<std::size_t>(aov)];
      const bool is_summand =
          options.with_usual_lights && source && may_hold_summands(parts, all, part, source->part);
      if (!is_summand) source.reset();
    }
    if (options.with_usual_lights) layers.lights = find_light_groups(parts, all, part);
    for (std::string name : options.additive) {
      std::optional<LightSource> light = find_additive_layer(parts, part, view, name);
      if (!light) {
        name = without_view(name, views);
        light = find_additive_layer(parts, part, view, name);
      }
      if (!light && view != views.front()) continue;
      if (!light) {
        throw Error(
            ExitStatus::bad_input,
            fmt::format("{}: no layer '{}' with channels R G B of the beauty's size; channels found: {}",
                        file, name, list_channels(parts)));
      }
      keep_light_group(name, *light, layers.lights);
      layers.lights.insert_or_assign(name, std::move(*light));
    }
    mark_subsampled(parts, layers);
  }
  return found;
}

}  // namespace becalm::io
