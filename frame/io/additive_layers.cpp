#include "frame/io/additive_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>

#include "frame/error.h"
#include "frame/io/additive_sums.h"
#include "frame/io/aliases.h"
#include "frame/io/channel_layers.h"
#include "frame/io/exr.h"
#include "frame/io/exr_file.h"
#include "frame/io/printable.h"

namespace becalm::io {
namespace {

/// Lower-case names of layers whose sum is the beauty; a file has some of a set. A renderer may offer several
/// sets, and a file may have more than one of them.
constexpr std::string_view kArnoldLobes[] = {"diffuse", "specular", "coat",     "sheen",     "transmission",
                                             "sss",     "volume",   "emission", "background"};
constexpr std::string_view kArnoldPaths[] = {
    "diffuse_direct",      "diffuse_indirect",      "specular_direct", "specular_indirect", "coat_direct",
    "coat_indirect",       "sheen_direct",          "sheen_indirect",  "sss_direct",        "sss_indirect",
    "transmission_direct", "transmission_indirect", "volume_direct",   "volume_indirect",   "emission",
    "background"};
constexpr std::string_view kArnoldOldPaths[] = {"direct_diffuse",
                                                "indirect_diffuse",
                                                "direct_specular",
                                                "indirect_specular",
                                                "reflection",
                                                "refraction",
                                                "sss",
                                                "emission",
                                                "background"};
constexpr std::string_view kDirectAndIndirect[] = {"direct", "indirect", "emission", "background"};
constexpr std::string_view kVray[] = {
    "lighting",        "gi",         "globalillumination", "reflection", "reflect",
    "refraction",      "refract",    "specular",           "sss",        "sss2",
    "caustics",        "background", "atmosphere",         "selfillum",  "sheen",
    "selfillumination"};
constexpr std::string_view kRedshift[] = {
    "diffuselighting", "specularlighting", "reflections",    "refractions",      "sss", "gi", "caustics",
    "emission",        "background",       "volumelighting", "volumefogemission"};
constexpr std::string_view kRenderMan[] = {"directdiffuse",    "indirectdiffuse", "directspecular",
                                           "indirectspecular", "subsurface",      "transmissive",
                                           "emissive",         "background"};
constexpr std::string_view kRenderManLobes[] = {"diffuse", "specular", "subsurface", "transmissive",
                                                "emissive"};
constexpr std::string_view kBlender[] = {"diffdir",  "diffind",   "glossdir",  "glossind", "transdir",
                                         "transind", "volumedir", "volumeind", "emit",     "env"};
/// A transparent film keeps the environment, the last of them, out of the beauty, but not out of its layer.
constexpr auto kBlenderFilm = std::span(kBlender).first(std::size(kBlender) - 1);

constexpr std::span<const std::string_view> kSets[] = {
    kBlender,           kBlenderFilm, kArnoldLobes, kArnoldPaths, kArnoldOldPaths,
    kDirectAndIndirect, kVray,        kRedshift,    kRenderMan,   kRenderManLobes};

/// What the names of Arnold's and of Cycles' light groups begin with; the scene gives the rest.
constexpr std::string_view kLightGroups[] = {"rgba_", "combined_"};
/// What the names of Arnold's own denoised layers begin with.
constexpr std::string_view kArnoldsDenoised = "rgba_denoise";

/// Blender's light of these layers is multiplied by the surface's colour in another layer.
struct ColouredBy {
  std::string_view light;
  std::string_view colour;
};
constexpr ColouredBy kColours[] = {{"diffdir", "diffcol"},   {"diffind", "diffcol"},
                                   {"glossdir", "glosscol"}, {"glossind", "glosscol"},
                                   {"transdir", "transcol"}, {"transind", "transcol"}};

/// Frames without such layers after which a sequence has none.
constexpr int kMostWithout = 8;

const ChannelLayer* find_layer(const std::vector<ChannelLayer>& layers, std::string_view name,
                               const Imath::Box2i& window, const std::vector<PartChannels>& parts) {
  const std::string lower_name = lower(name);
  for (const bool exact : {true, false}) {  // names may differ in case alone
    for (const bool whole : {true, false}) {
      for (const ChannelLayer& layer : layers) {
        const std::optional<std::string_view> scope = scope_before(layer.name(), lower_name);
        const bool matches = scope && (scope->empty() || !whole) && (!exact || layer.title.ends_with(name));
        if (matches && parts[layer.part].data_window == window && channels_as(layer, Aov::direct))
          return &layer;
      }
    }
  }
  return nullptr;
}

/// The layer's own name after its view layer's.
std::string_view end_of(std::string_view name) {
  return without_vray(name.substr(name.rfind('.') + 1));
}

bool is_of_group(std::string_view name, std::string_view group) {
  return name.starts_with(group) && !name.starts_with(kArnoldsDenoised) && !names_an_aov(name);
}

/// The scopes whose layers may be summands of the beauty: its own, or any where it has none.
std::set<std::string_view> scopes_beside(const LayerSource& beauty, const std::vector<ChannelLayer>& layers) {
  std::set<std::string_view> all;
  for (const ChannelLayer& layer : layers) {
    const std::optional<LayerSource> source = channels_as(layer, Aov::beauty);
    const bool is_beauty =
        source && source->part == beauty.part && source->channels.front() == beauty.channels.front();
    if (const std::string_view scope = scope_of(layer.name()); is_beauty && !scope.empty()) return {scope};
    all.insert(scope_of(layer.name()));
  }
  return all;
}

/// The light groups of another data window than the beauty's.
AdditiveSet cropped_light_groups(const std::vector<ChannelLayer>& layers,
                                 const std::vector<PartChannels>& parts, const Imath::Box2i& window) {
  AdditiveSet set;
  for (const ChannelLayer& layer : layers) {
    const bool is_cropped = parts[layer.part].data_window != window;
    if (is_cropped && layer.name().starts_with(kLightScope) && channels_as(layer, Aov::direct))
      set.layers.push_back(layer.title);
  }
  set.cropped = set.layers;
  return set;
}

/// Direct and indirect light that its data window keeps from being denoised, each a set of its own.
std::vector<AdditiveSet> cropped_aovs(const std::string& path, const std::vector<PartChannels>& parts,
                                      const LayerOptions& options, const ViewLayers& view) {
  std::vector<AdditiveSet> sets;
  const Imath::Box2i& window = parts[view.layers[static_cast<std::size_t>(Aov::beauty)]->part].data_window;
  const LayerMap found = find_layers(path, parts, options, view.view);  // view lacks those of another window
  const std::vector<ChannelLayer> layers = collect_layers(parts, view.view);
  for (const Aov aov : {Aov::direct, Aov::indirect}) {
    const std::optional<LayerSource>& source = found[static_cast<std::size_t>(aov)];
    if (!source || parts[source->part].data_window == window) continue;
    for (const ChannelLayer& layer : layers) {
      const std::optional<LayerSource> as_aov = channels_as(layer, aov);
      if (as_aov && as_aov->part == source->part && as_aov->channels == source->channels)
        sets.push_back({.layers = {layer.title}, .cropped = {layer.title}});
    }
  }
  return sets;
}

/// The candidates of a file: sets of at least two layers, and cropped light groups.
std::vector<AdditiveSet> candidates(const std::vector<PartChannels>& parts, const ViewLayers& view) {
  const LayerSource& beauty = *view.layers[static_cast<std::size_t>(Aov::beauty)];
  const Imath::Box2i& window = parts[beauty.part].data_window;
  const std::vector<ChannelLayer> layers = collect_layers(parts, view.view);
  // The beauty itself, and V-Ray's `diffuse`, which is its albedo.
  const auto is_taken = [&](const LayerSource& source) {
    return std::ranges::any_of(kAovTable, [&](const AovInfo& entry) {
      const auto& taken = view.layers[static_cast<std::size_t>(entry.aov)];
      if (!taken || taken->part != source.part || entry.aov == Aov::direct || entry.aov == Aov::indirect)
        return false;
      return taken->channels.front() == source.channels.front();
    });
  };
  const std::set<std::string_view> scopes = scopes_beside(beauty, layers);
  std::vector<AdditiveSet> sets;
  const auto add_of_scope = [&](std::string_view scope, auto is_of_set) {
    AdditiveSet set;
    std::set<std::string> denoised;  // without the set
    for (const ChannelLayer& layer : layers) {
      const std::string_view own_scope = scope_of(layer.name());
      if (!is_of_set(end_of(layer.name())) || (!own_scope.empty() && own_scope != scope)) continue;
      if (layer.name().starts_with(kLightScope)) continue;  // denoised, whatever adds up
      const auto source = channels_as(layer, Aov::direct);
      if (!source || is_taken(*source)) continue;
      set.layers.push_back(layer.title);
      if (is_denoised_aov(view, *source)) denoised.insert(layer.title);
      if (parts[layer.part].data_window != window) set.cropped.push_back(layer.title);
    }
    if (set.layers.size() < 2) return;
    if (!set.cropped.empty())
      std::erase_if(set.layers, [&](const std::string& name) { return denoised.contains(name); });
    const auto is_same = [&](const AdditiveSet& other) { return other.layers == set.layers; };
    if (std::ranges::none_of(sets, is_same)) sets.push_back(std::move(set));
  };
  const auto add = [&](auto is_of_set) {
    for (const std::string_view scope : scopes) add_of_scope(scope, is_of_set);
  };
  for (const std::span<const std::string_view> set : kSets) {
    add([&](std::string_view name) { return std::ranges::find(set, name) != set.end(); });
  }
  for (const std::string_view group : kLightGroups) {
    add([&](std::string_view name) { return is_of_group(name, group); });
  }
  if (AdditiveSet cropped = cropped_light_groups(layers, parts, window); !cropped.layers.empty())
    sets.push_back(std::move(cropped));
  return sets;
}

std::vector<AdditiveSet> candidates_of(const std::string& path, const LayerOptions& options) {
  std::vector<AdditiveSet> sets;
  reading(path, [&] {
    const std::vector<PartChannels> parts = part_channels(*open_exr(path));
    const ViewLayers view = find_view_layers(path, parts, options).front();
    sets = candidates(parts, view);
    for (AdditiveSet& aov : cropped_aovs(path, parts, options, view)) {
      const auto tells_of_it = [&](const AdditiveSet& set) {
        return std::ranges::find(set.cropped, aov.layers.front()) != set.cropped.end();
      };
      if (std::ranges::none_of(sets, tells_of_it)) sets.push_back(std::move(aov));
    }
  });
  return sets;
}

}  // namespace

std::optional<LightSource> find_additive_layer(const std::vector<PartChannels>& parts, int part,
                                               const std::string& view, const std::string& name) {
  const Imath::Box2i& window = parts[part].data_window;
  const std::vector<ChannelLayer> layers = collect_layers(parts, view);
  const ChannelLayer* layer = find_layer(layers, name, window, parts);
  if (layer == nullptr) return std::nullopt;
  LightSource light{*channels_as(*layer, Aov::direct)};
  const std::string_view end = end_of(layer->name());
  for (const ColouredBy& row : kColours) {
    if (row.light != end) continue;
    const std::string colour =
        layer->name().substr(0, layer->name().size() - end.size()) + std::string(row.colour);
    if (const ChannelLayer* found = find_layer(layers, colour, window, parts)) {
      light.colour = channels_as(*found, Aov::direct);
    }
  }
  return light;
}

bool names_a_summand(std::string_view layer) {
  const std::string_view name = end_of(layer);
  return std::ranges::any_of(kSets,
                             [&](const auto& set) { return std::ranges::find(set, name) != set.end(); }) ||
         std::ranges::any_of(kLightGroups, [&](std::string_view group) { return is_of_group(name, group); });
}

std::vector<AdditiveSet> find_additive_sets(const std::string& path, const LayerOptions& options) {
  std::vector<AdditiveSet> sets = candidates_of(path, options);
  compare_sums(path, sets, options);
  return sets;
}

std::vector<AdditiveSet> find_additive_sets(std::span<const std::string> paths, const LayerOptions& options) {
  std::vector<AdditiveSet> of_black;
  int without = 0;
  for (const std::string& path : paths) {
    try {
      std::vector<AdditiveSet> candidates = candidates_of(path, options);
      if (candidates.empty() && ++without == kMostWithout) break;
      if (compare_sums(path, candidates, options)) return candidates;
      if (of_black.empty()) of_black = std::move(candidates);
    } catch (const Error& error) {
      if (error.status() == ExitStatus::resource) throw;  // other jobs of the shot would choose otherwise
      // Whoever needs this frame tells what is wrong.
    }
  }
  return of_black;
}

std::vector<std::string> additive_words(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    if (comma > begin) words.emplace_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return words;
}

std::vector<std::string> choose_additive(std::string_view text, const std::vector<AdditiveSet>& sets) {
  std::vector<std::string> chosen;
  if (text == "none") return chosen;
  const auto choose = [&](const std::string& layer) {
    if (std::ranges::find(chosen, layer) == chosen.end()) chosen.push_back(layer);
  };
  for (const std::string& word : additive_words(text)) {
    if (word != "auto") {
      choose(word);
      continue;
    }
    for (const AdditiveSet& set : sets) {
      if (set.adds_up()) std::ranges::for_each(set.layers, choose);
    }
  }
  return chosen;
}

std::string describe_lack(const std::vector<std::string>& layers, int frame) {
  return fmt::format(
      "{} are passed on noisy, since frame {} on disk lacks them; --additive NAME,... --context none "
      "denoises "
      "them in --frames that have them",
      printable(fmt::format("{}", fmt::join(layers, ", ")), 1500), frame);
}

std::string describe(const AdditiveSet& set) {
  const auto listed = [](const std::vector<std::string>& layers) {
    return printable(fmt::format("{}", fmt::join(layers, ", ")), 1500);
  };
  const std::string names = listed(set.layers);
  if (!set.cropped.empty()) {
    const bool is_one = set.cropped.size() == 1;
    const std::string which = set.cropped != set.layers ? listed(set.cropped) : is_one ? "it" : "they";
    return fmt::format("{} {} passed on noisy, since {} {} another data window than the beauty", names,
                       set.layers.size() == 1 ? "is" : "are", which, is_one ? "has" : "have");
  }
  if (set.adds_up()) return fmt::format("{} add up to the beauty and are denoised with it", names);
  return fmt::format(
      "{} do not add up to the beauty in {:.1f}% of the values and are passed on noisy; --additive "
      "auto,NAME,... denoises them, too",
      names, 100.0 * set.share_off);
}

}  // namespace becalm::io
