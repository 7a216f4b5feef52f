#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "frame/aov.h"

namespace becalm::io {

/// One row: a layer of this name is this AOV. Names are lower case, as are those they are compared with; a
/// view layer's or a scene's name and a dot may stand before them. An empty name means bare channels.
struct Alias {
  Aov aov;
  std::string_view layer;
  /// Brings the writer's motion to offset_cur_to_prev_px.
  std::array<float, 2> scale{1.0f, 1.0f};
  bool standard_deviation = false;
  /// The name means something else in other renderers' files: it counts only in V-Ray's.
  bool vray_only = false;
};

/// Rows of one AOV stand in the order of preference.
std::span<const Alias> aliases();

/// What stands before the alias in the layer's name, without the dot ("" for nothing), or nullopt where the
/// layer is not of that alias.
std::optional<std::string_view> scope_before(std::string_view layer, std::string_view alias);

/// Whether a row of another AOV than the beauty has this name.
bool names_an_aov(std::string_view layer);

/// Whether only V-Ray calls a layer so.
bool is_vrays(std::string_view layer);

}  // namespace becalm::io
