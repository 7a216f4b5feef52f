#include "app/duration.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "frame/error.h"

namespace becalm::app {

std::optional<double> parse_duration(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 5> units{
      {{"", 1.0}, {"s", 1.0}, {"ms", 1e-3}, {"m", 60.0}, {"h", 3600.0}}};
  double value = 0.0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc()) return std::nullopt;
  const std::string_view rest(end, text.data() + text.size());
  for (const auto& [unit, seconds] : units) {
    if (rest == unit && value > 0.0 && std::isfinite(value)) return value * seconds;
  }
  return std::nullopt;
}

double duration_of(std::string_view option, const std::string& text) {
  if (const std::optional<double> seconds = parse_duration(text)) return *seconds;
  throw Error(ExitStatus::usage,
              fmt::format("{} {}: expected a time, such as 2s, 500ms, 1.5m or 1h", option, text));
}

}  // namespace becalm::app
