#include "app/alpha_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "filter/sequence/alpha.h"
#include "frame/error.h"

namespace becalm::app {
namespace {

/// Rendered views have no layers of a file; they have alpha.
bool has_alpha(const io::LoadedView& view) {
  const std::optional<io::LayerSource>& beauty = view.layers[static_cast<std::size_t>(Aov::beauty)];
  return !beauty || !beauty->channels[3].empty();
}

std::size_t count_changed(const Image& before, const Image& after) {
  std::size_t changed = 0;
  for (std::size_t i = 3; i < before.data().size(); i += 4) {
    const auto bits = [&](const Image& image) { return std::bit_cast<std::uint32_t>(image.data()[i]); };
    changed += bits(before) != bits(after) ? 1 : 0;
  }
  return changed;
}

std::string outcome_text(std::size_t changed, std::size_t pixels) {
  return changed == 0 ? "passed on" : fmt::format("denoised in {} of {} pixels", changed, pixels);
}

}  // namespace

std::string alpha_outcome(const io::LoadedFrame& source, const Frame& denoised,
                          const std::vector<Frame>& other_views) {
  std::size_t changed = 0;
  std::size_t pixels = 0;
  const auto add = [&](const io::LoadedView& view, const Frame& frame) {
    if (!has_alpha(view)) return;
    changed += count_changed(view.frame.image(Aov::beauty), frame.image(Aov::beauty));
    pixels += frame.image(Aov::beauty).pixel_count();
  };
  add(source, denoised);
  for (std::size_t i = 0; i < other_views.size(); ++i) {
    add(i < source.other_views.size() ? source.other_views[i] : *source.other_eye, other_views[i]);
  }
  return pixels == 0 ? "" : outcome_text(changed, pixels);
}

std::string alpha_outlook(const std::string& path, const io::LayerOptions& layers) {
  try {
    const io::LoadedFrame loaded = io::read_exr(path, 1, {}, layers);
    if (!has_alpha(loaded)) return "";
    const Image& beauty = loaded.frame.image(Aov::beauty);
    const std::ptrdiff_t noisy = std::ranges::count(filter::noisy_alpha(beauty), 1);
    if (noisy == 0) return "alpha: passed on as it is";
    return fmt::format(
        "alpha: passed on as it is; {:.1f} % of its pixels look noisy, and --alpha denoise denoises these",
        100.0 * static_cast<double>(noisy) / static_cast<double>(beauty.pixel_count()));
  } catch (const Error& error) {
    if (error.status() == ExitStatus::resource) throw;
    return "";
  }
}

}  // namespace becalm::app
