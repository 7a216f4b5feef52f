#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frame/io/layers.h"

namespace becalm::io {

std::string lower(std::string_view text);

/// The view layer's or scene's name before a layer's own name, such as `viewlayer` of `viewlayer.combined`.
std::string_view scope_of(std::string_view layer);

/// A layer's or part's name without the word between its dots that is a view's: `diffuse` of `left.diffuse`.
/// The name itself where there is no such word.
std::string without_view(const std::string& name, const std::vector<std::string>& views);

/// The channels of one view in one layer of one part, by lower-case letter. A channel whose name does
/// not end in a letter or a colour is a layer of its own, and has letter 0.
struct ChannelLayer {
  int part = 0;
  std::string part_name;   ///< lower case, without the view
  std::string own_name;    ///< lower case, without the view; empty for bare channels
  std::string title = {};  ///< name() as the file has it
  std::map<char, std::string> channels = {};
  bool spells_colours_out = false;  ///< `.red` instead of `.R`

  /// What the layer goes by: bare channels have their part's name.
  const std::string& name() const { return own_name.empty() ? part_name : own_name; }
  /// Whether these are bare channels of a part whose name is not that of another AOV: they may be a beauty.
  bool is_bare() const;
};

/// The layers of a view (of find_views), in the order in which their first channels stand in the file.
std::vector<ChannelLayer> collect_layers(const std::vector<PartChannels>& parts, const std::string& view);

/// The layer's channels as those of the AOV, if it has them all. Alpha may be missing, and a variance of one
/// channel serves for all three. Bare channels count as colour, or as depth if they have a Z without X and Y,
/// and as nothing else.
std::optional<LayerSource> channels_as(const ChannelLayer& layer, Aov aov);

}  // namespace becalm::io
