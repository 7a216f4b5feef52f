#include "frame/io/jitter_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>

namespace becalm::io {
namespace {

constexpr std::array<std::string_view, 3> kShapes{"blackman_harris", "box", "tent"};

}  // namespace

std::string format_jitter(const FrameJitter& jitter) {
  std::string text =
      fmt::format("{} {}:", kShapes[static_cast<std::size_t>(jitter.filter)], jitter.radius_px);
  for (const Imath::V2f& position : jitter.positions_px) {
    text +=
        fmt::format("{} {} {}", &position == jitter.positions_px.data() ? "" : ",", position.x, position.y);
  }
  return text;
}

std::optional<FrameJitter> parse_jitter(std::string_view text) {
  const auto colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto words = [](std::string_view part) {
    std::istringstream stream{std::string(part)};
    stream.imbue(std::locale::classic());
    return stream;
  };
  FrameJitter jitter;
  std::istringstream head = words(text.substr(0, colon));
  std::string shape;
  std::string rest;
  if (!(head >> shape >> jitter.radius_px) || head >> rest) return std::nullopt;
  const auto known = std::ranges::find(kShapes, shape);
  if (known == kShapes.end() || !(jitter.radius_px >= 0.0f && jitter.radius_px <= 32.0f)) return std::nullopt;
  jitter.filter = static_cast<FilterShape>(known - kShapes.begin());
  text.remove_prefix(colon + 1);
  while (true) {
    const auto comma = text.find(',');
    std::istringstream pair = words(text.substr(0, comma));
    Imath::V2f position;
    if (!(pair >> position.x >> position.y) || pair >> rest) return std::nullopt;
    if (!(std::abs(position.x) <= 64.0f && std::abs(position.y) <= 64.0f)) return std::nullopt;
    jitter.positions_px.push_back(position);
    if (comma == std::string_view::npos) return jitter;
    text.remove_prefix(comma + 1);
  }
}

std::optional<Parity> parse_checkerboard(std::string_view text, const Imath::V2i& first) {
  if (text != "even" && text != "odd") return std::nullopt;
  const bool is_odd = (text == "odd") != (((first.x + first.y) & 1) != 0);
  return is_odd ? Parity::odd : Parity::even;
}

}  // namespace becalm::io
