#include "frame/io/additive_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "frame/io/exr.h"
#include "frame/io/exr_file.h"

namespace becalm::io {
namespace {

/// Relative error by rounding to half: of each summand, of the colour that it is multiplied by, and of the
/// sum.
constexpr double kHalfRounding = 2.0 / 1024.0;
/// The same by lossy compression: frames of Blender by DWAA and DWAB have up to 0.05.
constexpr double kLossyRounding = 0.1;
/// Absolute error by rounding to half near 0: its smallest step, 6e-8, for many summands.
constexpr double kSmallest = 1e-6;
/// Share of the values that may be farther off, such as clamped fireflies.
constexpr double kAllowedShare = 1e-3;
/// Share of a frame's values that must not be black for it to tell whether layers add up.
constexpr double kLeastLit = 1e-3;

/// Relative error of the sum that the file's part explains.
double rounding_of(const Imf::Header& header) {
  switch (header.compression()) {
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return kLossyRounding;
    default:
      return kHalfRounding;
  }
}

/// What a frame tells of layers: AdditiveSet without them.
AdditiveSet compared(const Frame& frame, double rounding) {
  const Image& beauty = frame.image(Aov::beauty);
  std::size_t off = 0;
  std::size_t lit = 0;
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double wanted = beauty.data()[4 * i + c];
      double sum = 0.0;
      double size = std::abs(wanted);
      for (const LightGroup& group : frame.light_groups()) {
        const double part = group.radiance.data()[3 * i + c];
        sum += part;
        size += std::abs(part);
      }
      if (std::abs(sum - wanted) > rounding * size + kSmallest) ++off;
      if (size > 0.0) ++lit;
    }
  }
  return {.layers = {},
          .cropped = {},
          .share_off = static_cast<double>(off) / static_cast<double>(std::max<std::size_t>(lit, 1)),
          .is_certain = static_cast<double>(lit) > kLeastLit * static_cast<double>(3 * beauty.pixel_count())};
}

/// Whether `outer` has all layers of `inner` and more.
bool holds(const AdditiveSet& outer, const AdditiveSet& inner) {
  return outer.layers.size() > inner.layers.size() &&
         std::ranges::all_of(inner.layers, [&](const std::string& name) {
           return std::ranges::find(outer.layers, name) != outer.layers.end();
         });
}

/// Of sets of which one holds the other only one stays: the larger that adds up, else the smaller that does,
/// else the larger.
void leave_one_of_nested(std::vector<AdditiveSet>& sets) {
  const std::vector<AdditiveSet> all = sets;
  std::erase_if(sets, [&](const AdditiveSet& set) {
    return std::ranges::any_of(all, [&](const AdditiveSet& other) {
      return (holds(other, set) && (other.adds_up() || !set.adds_up())) ||
             (holds(set, other) && other.adds_up() && !set.adds_up());
    });
  });
}

/// Reads the set's layers and compares their sum with the beauty. Layers that are AOVs leave the set after
/// that.
void compare(const std::string& path, AdditiveSet& set, const LayerOptions& options) {
  std::vector<std::string> layers = std::move(set.layers);
  LayerOptions with_layers = options;
  with_layers.additive = layers;
  LoadedFrame loaded = read_exr(path, 0, {}, with_layers, LightGroups::read);
  std::erase_if(loaded.frame.light_groups(), [&](const LightGroup& group) {
    return std::ranges::find(layers, group.name) == layers.end();
  });
  const int part = loaded.layers[static_cast<std::size_t>(Aov::beauty)]->part;
  double rounding = 0.0;
  reading(path, [&] { rounding = rounding_of(open_exr(path)->header(part)); });
  set = compared(loaded.frame, rounding);
  std::erase_if(
      layers, [&](const std::string& name) { return is_denoised_aov(loaded, loaded.lights.at(name).layer); });
  set.layers = std::move(layers);
}

}  // namespace

bool is_denoised_aov(const ViewLayers& view, const LayerSource& layer) {
  return std::ranges::any_of(std::array{Aov::direct, Aov::indirect}, [&](Aov aov) {
    const auto& source = view.layers[static_cast<std::size_t>(aov)];
    return source && source->part == layer.part && source->channels == layer.channels;
  });
}

bool compare_sums(const std::string& path, std::vector<AdditiveSet>& sets, const LayerOptions& options) {
  bool is_certain = false;
  // The largest first: of a set that adds up no part needs to be read.
  std::vector<AdditiveSet*> by_size(sets.size());
  std::ranges::transform(sets, by_size.begin(), [](AdditiveSet& set) { return &set; });
  std::ranges::stable_sort(by_size, std::greater{},
                           [](const AdditiveSet* set) { return set->layers.size(); });
  std::vector<AdditiveSet> complete;
  for (AdditiveSet* set : by_size) {
    if (!set->cropped.empty()) {
      set->share_off = 1.0;
      set->is_certain = false;
      continue;
    }
    const AdditiveSet whole = *set;
    if (std::ranges::any_of(complete, [&](const AdditiveSet& outer) { return holds(outer, whole); })) {
      set->layers.clear();
      continue;
    }
    compare(path, *set, options);
    is_certain |= set->is_certain;
    if (set->adds_up()) complete.push_back(whole);
  }
  std::erase_if(sets, [](const AdditiveSet& set) { return set.layers.empty(); });
  leave_one_of_nested(sets);
  return is_certain;
}

bool AdditiveSet::adds_up() const {
  return share_off <= kAllowedShare;
}

}  // namespace becalm::io
