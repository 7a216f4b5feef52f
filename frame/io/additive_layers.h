#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frame/io/layers.h"

namespace becalm::io {

/// What the names of light groups begin with.
inline constexpr std::string_view kLightScope = "light.";

/// The layer whose name this is, or ends in this after a dot, as a summand of the beauty of `part`; with its
/// colour pass if it is one of Blender's. Nothing if no such layer has R, G, B and that part's data window.
std::optional<LightSource> find_additive_layer(const std::vector<PartChannels>& parts, int part,
                                               const std::string& view, const std::string& name);

/// Whether a renderer calls a summand of the beauty so.
bool names_a_summand(std::string_view layer);

/// Layers whose sum should be the beauty, such as diffuse and specular light, or the light groups.
struct AdditiveSet {
  std::vector<std::string> layers;
  /// Those of another data window than the beauty's: nothing is known then.
  std::vector<std::string> cropped = {};
  /// Share of the values but black ones whose sum is farther from the beauty than rounding to half explains,
  /// or the file's lossy compression.
  double share_off = 0.0;
  bool is_certain = true;  ///< the frame is not black, and no layer cropped
  bool adds_up() const;
};

/// The sets that the names of a file's layers suggest, each with how well it adds up to the beauty of the
/// default view, and a set of the light groups that their data window keeps from being denoised. Reads their
/// pixels; throws as read_exr does.
std::vector<AdditiveSet> find_additive_sets(const std::string& path, const LayerOptions& options);

/// The sets of the first of these files that has such layers and in which more than a thousandth of the
/// values is not black; if there is none, of the first file with such layers. Files that cannot be read are
/// skipped; the search ends at the eighth file without such layers. Throws Error(resource).
std::vector<AdditiveSet> find_additive_sets(std::span<const std::string> paths, const LayerOptions& options);

/// The words between commas.
std::vector<std::string> additive_words(std::string_view text);

/// `--additive auto|NAME,NAME|auto,NAME|none`: the layers that are denoised with the beauty; for auto those
/// of the sets that add up.
std::vector<std::string> choose_additive(std::string_view text, const std::vector<AdditiveSet>& sets);

/// One line for layers that add up, and that a frame of the sequence lacks.
std::string describe_lack(const std::vector<std::string>& layers, int frame);

/// One line, for people.
std::string describe(const AdditiveSet& set);

}  // namespace becalm::io
