#include "frame/io/stereo_text.h"

#include <fmt/format.h>

#include <cmath>
#include <locale>
#include <sstream>

namespace becalm::io {

std::string format_stereo(const StereoView& view) {
  const StereoCamera& camera = view.camera;
  return fmt::format("{} focal_px={} separation={} convergence={}", view.eye == Eye::left ? "left" : "right",
                     camera.focal_px, camera.separation, camera.convergence);
}

std::optional<StereoView> parse_stereo(std::string_view text) {
  std::istringstream words{std::string(text)};
  words.imbue(std::locale::classic());
  std::string eye;
  if (!(words >> eye) || (eye != "left" && eye != "right")) return std::nullopt;
  StereoView view{.camera = {}, .eye = eye == "left" ? Eye::left : Eye::right};
  const auto read = [&](std::string_view key, double& value) {
    std::string word;
    if (!(words >> word) || !word.starts_with(key) || word[key.size()] != '=') return false;
    std::istringstream number(word.substr(key.size() + 1));
    number.imbue(std::locale::classic());
    return number >> value && number.eof() && std::isfinite(value);
  };
  StereoCamera& camera = view.camera;
  std::string rest;
  const bool is_whole = read("focal_px", camera.focal_px) && read("separation", camera.separation) &&
                        read("convergence", camera.convergence) && !(words >> rest);
  const bool is_camera = camera.focal_px > 0.0 && camera.separation >= 0.0 && camera.convergence > 0.0;
  return is_whole && is_camera ? std::optional(view) : std::nullopt;
}

}  // namespace becalm::io
