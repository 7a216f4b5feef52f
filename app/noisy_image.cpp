#include "app/noisy_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <tuple>

#include "app/cancel.h"
#include "app/fingerprints.h"
#include "frame/error.h"
#include "frame/io/exr.h"

namespace becalm::app {
namespace {

/// Frames that are looked at; black ones may be a slate or a fade.
constexpr std::size_t kMostFrames = 8;
/// Beside bare channels.
constexpr std::string_view kNoisyOfBare = "Beauty_Noisy";

/// The last words of the names of both layers.
struct Names {
  std::string_view denoised;
  std::string_view noisy;
};
constexpr Names kNames[] = {{"Combined", "Noisy Image"}, {"Beauty", kNoisyOfBare}};

/// What may lie beside the beauty, by layer or by part. Of several views these names end in the view's.
std::optional<NoisyImage> beside(const io::ExrView& view) {
  const io::LayerSource& beauty = *view.layers[static_cast<std::size_t>(Aov::beauty)];
  const std::string& channel = beauty.channels.front();
  const std::size_t dot = channel.rfind('.');
  std::string title = dot == std::string::npos ? view.part_names[static_cast<std::size_t>(beauty.part)]
                                               : channel.substr(0, dot);
  if (!view.view.empty() && title.ends_with('.' + view.view))
    title.resize(title.size() - view.view.size() - 1);
  if (title.empty()) return NoisyImage{std::string(kNoisyOfBare), "RGBA"};
  const auto* const names =
      std::ranges::find_if(kNames, [&](const Names& pair) { return title.ends_with(pair.denoised); });
  if (names == std::end(kNames)) return std::nullopt;
  return NoisyImage{title.substr(0, title.size() - names->denoised.size()).append(names->noisy), title};
}

/// Whether the file is an output of becalm, which has denoised its beauty: then that differs for this reason.
bool is_denoised_by_becalm(const std::string& path, const io::ExrView& view) {
  const std::string taken = io::read_attribute(path, kLayersAttribute) + ' ';
  return taken.find(layers_text(view, AovSet().set(static_cast<std::size_t>(Aov::beauty))) + ' ') !=
         std::string::npos;
}

/// Whether both layers of a file are different pictures; nothing if they are black.
std::optional<bool> differ(const std::string& path, const NoisyImage& noisy, const io::LayerOptions& layers) {
  io::LayerOptions with_noisy = layers;
  with_noisy.layers[Aov::beauty] = noisy.layer;
  // Throws, before any pixel is read, if there is no such layer.
  std::ignore = io::read_exr_header(path, with_noisy, io::CheckChunks::no);
  const io::LoadedFrame a = io::read_exr(path, 1, {}, layers);
  // In one place: each part may be cropped in its own way.
  const io::LoadedFrame b = io::read_exr(path, 1, {}, with_noisy, io::LightGroups::leave, a.window);
  const std::span<const float> combined = a.frame.image(Aov::beauty).data();
  const std::span<const float> rendered = b.frame.image(Aov::beauty).data();
  bool is_black = true;
  bool is_same = true;
  for (std::size_t i = 0; i < combined.size(); ++i) {
    if (i % 4 == 3) continue;  // alpha
    if (std::isnan(combined[i]) || std::isnan(rendered[i])) continue;
    is_black = is_black && combined[i] == 0.0f && rendered[i] == 0.0f;
    is_same = is_same && combined[i] == rendered[i];
  }
  return is_black ? std::nullopt : std::optional(!is_same);
}

}  // namespace

std::string NoisyImage::text() const {
  return fmt::format("{} is denoised already and passed on: {} is the beauty; --layers 'beauty={}' overrules",
                     denoised, layer, denoised);
}

std::optional<NoisyImage> take_noisy_image(const std::vector<NumberedFile>& files, io::LayerOptions& layers) {
  if (layers.layers.contains(Aov::beauty)) return std::nullopt;
  for (const NumberedFile& file : std::span(files).first(std::min(files.size(), kMostFrames))) {
    stop_if_asked();
    try {
      const io::ExrView view = io::read_exr_header(file.path, layers, io::CheckChunks::no).front();
      auto noisy = beside(view);
      if (!noisy || is_denoised_by_becalm(file.path, view)) return std::nullopt;
      if (const std::optional<bool> is_other = differ(file.path, *noisy, layers)) {
        if (!*is_other) return std::nullopt;
        layers.layers[Aov::beauty] = noisy->layer;
        return noisy;
      }
    } catch (const Error& error) {
      if (error.status() == ExitStatus::resource) throw;
      continue;  // without such a layer, or damaged
    }
  }
  return std::nullopt;
}

}  // namespace becalm::app
