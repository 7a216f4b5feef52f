#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frame/io/layers.h"

namespace becalm::io {

std::string lower(std::string_view text);

/// The channels of one layer of one part that belong to one view, by lower-case letter; 0 for a channel
/// without a letter, which is a layer of its own.
struct ChannelLayer {
  int part = 0;
  std::string part_name;   ///< lower case, without the view
  std::string own_name;    ///< lower case, without the view; empty for bare channels
  std::string title = {};  ///< own_name as the file has it
  std::map<char, std::string> channels = {};
  bool spells_colours_out = false;  ///< `.red` instead of `.R`

  /// What the layer goes by: bare channels have their part's name.
  const std::string& name() const { return own_name.empty() ? part_name : own_name; }
  /// Bare channels whose part's name does not say that they are something else than a beauty.
  bool is_bare() const;
};

/// The layers of a view (of find_views), in the order in which their first channels stand in the file.
std::vector<ChannelLayer> collect_layers(const std::vector<PartChannels>& parts, const std::string& view);

/// The layer's channels as those of the AOV, if it has them all; alpha alone may be missing, and a variance
/// of one channel counts for all three. Of bare channels only colours and a Z that no X and Y stand beside
/// are certain.
std::optional<LayerSource> channels_as(const ChannelLayer& layer, Aov aov);

}  // namespace becalm::io
