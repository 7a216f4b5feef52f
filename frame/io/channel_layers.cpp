#include "frame/io/channel_layers.h"

#include <algorithm>
#include <cctype>

#include "frame/io/aliases.h"

namespace becalm::io {
namespace {

/// Ways to spell an AOV's channels, in the order of kAovTable's letters.
struct Spelling {
  std::string_view table_channels;
  std::string_view letters;
};

constexpr Spelling kSpellings[] = {
    {"RGBA", "rgba"}, {"RGB", "rgb"}, {"XYZ", "xyz"}, {"XYZ", "rgb"}, {"Z", "z"},
    {"Z", "v"},       {"Z", "y"},     {"Z", "r"},     {"Z", "t"},     {"XY", "xy"},
    {"XY", "rg"},     {"XY", "uv"},   {"Y", "y"},     {"Y", "v"},     {"Y", "r"},
};

struct SpelledLetter {
  std::string_view word;
  char letter;
};

constexpr SpelledLetter kSpelledLetters[] = {{"red", 'r'}, {"green", 'g'}, {"blue", 'b'}, {"alpha", 'a'}};

/// A layer's name and the channel's lower-case letter (or 0) in a channel's name. Layer names may hold dots
/// and spaces, so only the last dot counts.
struct ChannelName {
  std::string title;  ///< as the file has it
  char letter = '\0';
  bool is_spelled_out = false;
};

ChannelName split_channel(std::string_view channel) {
  const std::size_t dot = channel.rfind('.');
  const std::string suffix = lower(dot == std::string::npos ? channel : channel.substr(dot + 1));
  const std::string title(dot == std::string::npos ? "" : channel.substr(0, dot));
  if (suffix.size() == 1) return {title, suffix[0]};
  for (const SpelledLetter& spelled : kSpelledLetters) {
    if (spelled.word == suffix) return {title, spelled.letter, true};
  }
  return {std::string(channel)};
}

/// The words between the dots of a name.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t dot = std::min(name.find('.', begin), name.size());
    words.push_back(name.substr(begin, dot - begin));
    begin = dot + 1;
  }
  return words;
}

/// The name without the word at `index`.
std::string without_word(const std::vector<std::string>& words, std::size_t index) {
  std::string name;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i == index) continue;
    if (!name.empty()) name += '.';
    name += words[i];
  }
  return name;
}

struct ViewChannel {
  std::string view;
  std::string name;  ///< without the view's
};

/// OpenEXR has the view's name before the channel's letter (`albedo.right.R`), other writers have it in
/// front. Without one a channel is the default view's: an eye must not be given the other's AOVs.
ViewChannel split_view(const std::string& channel, const std::vector<std::string>& views) {
  if (views.empty()) return {"", channel};
  const std::vector<std::string> words = words_of(channel);
  if (words.size() > 1) {
    for (const std::size_t index : {words.size() - 2, std::size_t{0}}) {
      for (const std::string& view : views) {
        if (lower(words[index]) == lower(view)) return {view, without_word(words, index)};
      }
    }
  }
  return {views.front(), channel};
}

std::string name_without_view(const std::string& part_name, const std::string& view) {
  const std::vector<std::string> words = words_of(part_name);
  const auto at = std::ranges::find(words, lower(view), lower);
  return view.empty() || at == words.end()
             ? part_name
             : without_word(words, static_cast<std::size_t>(at - words.begin()));
}

}  // namespace

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string_view scope_of(std::string_view layer) {
  const std::size_t dot = layer.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : layer.substr(0, dot);
}

std::string without_view(const std::string& name, const std::vector<std::string>& views) {
  for (const std::string& view : views) {
    if (std::string without = name_without_view(name, view); without != name) return without;
  }
  return name;
}

bool ChannelLayer::is_bare() const {
  return own_name.empty() && (part_name.empty() || !names_an_aov(part_name));
}

std::vector<ChannelLayer> collect_layers(const std::vector<PartChannels>& parts, const std::string& view) {
  const std::string default_view = find_views(parts).front();
  std::vector<ChannelLayer> layers;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartChannels& part = parts[i];
    const std::vector<std::string> views = part.view.empty() ? part.multi_view : std::vector<std::string>();
    for (const std::string& channel : part.channels) {
      ViewChannel viewed = split_view(channel, views);
      if (viewed.view.empty()) viewed.view = part.view.empty() ? default_view : part.view;
      if (viewed.view != view) continue;
      const ChannelName name = split_channel(viewed.name);
      const std::string own_name = lower(name.title);
      const auto is_same = [&](const ChannelLayer& other) {
        // Searches ignore case, but names that differ in case alone are two layers.
        return other.part == static_cast<int>(i) && other.own_name == own_name &&
               (own_name.empty() || other.title == name.title);
      };
      auto layer = std::ranges::find_if(layers, is_same);
      if (layer == layers.end()) {
        const std::string part_title = name_without_view(part.name, view);
        layer = layers.insert(layer, {.part = static_cast<int>(i),
                                      .part_name = lower(part_title),
                                      .own_name = own_name,
                                      .title = name.title.empty() ? part_title : name.title});
      }
      layer->channels.emplace(name.letter, channel);
      layer->spells_colours_out |= name.is_spelled_out;
    }
  }
  return layers;
}

std::optional<LayerSource> channels_as(const ChannelLayer& layer, Aov aov) {
  const auto has = [&](char letter) { return layer.channels.contains(letter); };
  const bool single = channel_count(aov) == 1;
  if (single && has('\0')) return LayerSource{layer.part, {layer.channels.at('\0')}};
  if (aov == Aov::depth && layer.is_bare() && has('x') && has('y')) return std::nullopt;
  for (const Spelling& spelling : kSpellings) {
    if (spelling.table_channels != info(aov).channels) continue;
    if (layer.is_bare() && aov == Aov::depth && spelling.letters != "z") continue;
    LayerSource source{layer.part, {}};
    for (char letter : spelling.letters) {
      if (has(letter)) {
        source.channels.push_back(layer.channels.at(letter));
      } else if (letter == 'a') {
        source.channels.emplace_back();
      }
    }
    if (source.channels.size() == spelling.letters.size()) return source;
  }
  if (aov == Aov::variance && layer.channels.size() == 1) {
    return LayerSource{layer.part, std::vector<std::string>(3, layer.channels.begin()->second)};
  }
  return std::nullopt;
}

}  // namespace becalm::io
