#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frame/aov.h"

namespace becalm::io {

/// Where one AOV lies in a file: its part, and the file's channel name for each of the AOV's channels. A
/// beauty without alpha has an empty fourth name and is read as A = 1.
struct LayerSource {
  int part = 0;
  std::vector<std::string> channels;
  /// Multiplied into the second channel when it is read: -1 for motion that its writer counts upwards.
  float y_scale = 1.0f;
};

/// Which channels of a file were taken for which AOV, by index of kAovTable.
using LayerMap = std::array<std::optional<LayerSource>, kAovCount>;

/// `--layers albedo=NAME,normal=NAME,...`: layer names that overrule the alias table, by AOV. A name is a
/// layer's whole name, its end after a dot (`Denoising Albedo` for `ViewLayer.Denoising Albedo`), or a bare
/// channel such as `Z`; the letters' case does not count. A layer that the alias table knows keeps the
/// table's convention.
using LayerOverrides = std::map<Aov, std::string>;

/// Throws Error(usage) for an unknown AOV or a missing name.
LayerOverrides parse_layer_overrides(std::string_view text);

/// Finds the AOVs among the channel names of each part, by the alias table (Blender's view layers, bare
/// names, and becalm's own). AOVs come from the beauty's view layer or from no view layer. Throws
/// Error(bad_input) naming `file` if an override names a layer that is not there, or if there is no colour;
/// that message lists the channels found.
LayerMap find_layers(const std::string& file, const std::vector<std::vector<std::string>>& part_channels,
                     const LayerOverrides& overrides);

}  // namespace becalm::io
