#pragma once

#include <Imath/ImathBox.h>

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "frame/aov.h"

namespace becalm::io {

/// Where one AOV lies in a file: its part, and the file's channel name for each of the AOV's channels. A
/// beauty without alpha has an empty fourth name and is read as A = 1; one channel may serve several.
struct LayerSource {
  int part = 0;
  std::vector<std::string> channels;
  /// Multiplied into each channel when it is read: -1 for motion that its writer counts the other way.
  std::array<float, 4> scale{1.0f, 1.0f, 1.0f, 1.0f};
  /// Each value is squared before that: a standard deviation that is read as a variance.
  bool squared = false;
  /// Some channel has fewer samples than pixels, so that the layer can only be passed on.
  bool subsampled = false;
};

/// Which channels of a file were taken for which AOV, by index of kAovTable.
using LayerMap = std::array<std::optional<LayerSource>, kAovCount>;

/// `--layers albedo=NAME,normal=PART/NAME,depth=none,...`: layer names that overrule the alias table, by AOV.
/// A name is a layer's whole name, its end after a dot (`Denoising Albedo` for `ViewLayer.Denoising Albedo`),
/// or a bare channel such as `Z`; bare channels of a part go by the part's name, or `RGBA` where it has none.
/// `PART/NAME` looks in that part only. `none` leaves the AOV out. The letters' case does not count. A layer
/// that the alias table knows keeps the table's convention. Of a name with a view's, such as `left.diffuse`,
/// each eye takes its own.
using LayerOverrides = std::map<Aov, std::string>;

/// Throws Error(usage) for an unknown AOV, a missing name, or a beauty of none.
LayerOverrides parse_layer_overrides(std::string_view text);

/// `--motion flip-x,flip-y,scale=S,swap`: what is done to motion vectors after the alias table's convention.
struct MotionChange {
  bool swap = false;  ///< the layer's two channels change places first
  std::array<float, 2> scale{1.0f, 1.0f};

  bool operator==(const MotionChange&) const = default;
};

/// Throws Error(usage) for an unknown word and for a scale that is no finite number or 0.
MotionChange parse_motion_change(std::string_view text);

/// How the user overrules what is found.
struct LayerOptions {
  LayerOverrides layers = {};
  MotionChange motion = {};
  /// Layers that are light groups, by name as for LayerOverrides.
  std::vector<std::string> additive = {};
  /// Whether direct and indirect light and `light.NAME` count besides.
  bool with_usual_lights = true;
};

/// What is known of a part before its pixels are read.
struct PartChannels {
  std::string name = {};  ///< empty where a file has but one part
  std::string view = {};  ///< the eye of a part that is of one
  std::vector<std::string> multi_view =
      {};                     ///< views whose names are in channel names; the first may be left out
  int samples_per_pixel = 0;  ///< as pbrt writes it; 0: not known
  std::vector<std::string> channels = {};
  std::set<std::string> subsampled = {};  ///< those of the channels that have fewer samples than pixels
  Imath::Box2i data_window = {};
};

/// The views of a stereo file, the default one first; one empty name where there are none.
std::vector<std::string> find_views(const std::vector<PartChannels>& parts);

/// Finds the AOVs of one of find_views() among the channels of each part, by the alias table. Bare channels
/// of a part are a layer of the part's name. AOVs come from the beauty's view layer or from no view layer,
/// and never from another view. Throws Error(bad_input) naming `file` if an override names a layer that is
/// not there, or if there is no colour; that message lists the channels found.
LayerMap find_layers(const std::string& file, const std::vector<PartChannels>& parts,
                     const LayerOptions& options, const std::string& view = "");

/// The titles of layers of a view, but for composites, that have a beauty's name in another view layer than
/// `beauty`, which is what was taken. They are passed on as they are.
std::vector<std::string> find_other_beauties(const std::vector<PartChannels>& parts,
                                             const LayerSource& beauty, const std::string& view);

/// A layer of radiance that is part of the beauty: alone, or times the surface's colour, as Blender has it.
struct LightSource {
  LayerSource layer;
  std::optional<LayerSource> colour = {};
};

struct ViewLayers {
  std::string view;  ///< empty in a file without named views
  LayerMap layers;
  /// Layers and parts `light.NAME`, by NAME or, where LayerOptions::additive has that name, by the whole; and
  /// those of LayerOptions::additive.
  std::map<std::string, LightSource> lights;
};

/// find_layers() for every view that has a beauty, and for the default one, which comes first. Direct and
/// indirect light and light groups are those of the beauty's part, or of others of its data window that hold
/// no other picture.
std::vector<ViewLayers> find_view_layers(const std::string& file, const std::vector<PartChannels>& parts,
                                         const LayerOptions& options);

}  // namespace becalm::io
