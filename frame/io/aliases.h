#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "frame/aov.h"

namespace becalm::io {

/// One row of the table of names: a layer of this name is this AOV. Names are compared in lower case, without
/// the name of a view layer or scene and the dot that may stand before them. An empty name means bare
/// channels.
struct Alias {
  Aov aov;
  std::string_view layer;
  /// Brings the writer's motion to offset_cur_to_prev_px.
  std::array<float, 2> scale{1.0f, 1.0f};
  bool standard_deviation = false;
  /// Counts in V-Ray's files only: elsewhere the name means something else.
  bool vray_only = false;
};

/// Rows of one AOV stand in the order of preference.
std::span<const Alias> aliases();

/// What stands before the alias in the layer's name, without the dot ("" for nothing), or nullopt where the
/// layer is not of that alias. The layer's own name may begin with `vray`.
std::optional<std::string_view> scope_before(std::string_view layer, std::string_view alias);

/// Whether a row of another AOV than the beauty has this name.
bool names_an_aov(std::string_view layer);

/// The name without the `vray` that V-Ray for 3ds Max puts in front of all layers' names.
std::string_view without_vray(std::string_view layer);

/// How much a layer's name tells that V-Ray wrote it: kVraysEvidence where only V-Ray calls one so, less for
/// names that others use too, 0 for others.
int evidence_of_vray(std::string_view layer);
inline constexpr int kVraysEvidence = 2;

}  // namespace becalm::io
