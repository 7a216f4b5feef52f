#include "app/byte_size.h"

#include <charconv>
#include <cmath>

namespace becalm::app {

std::optional<std::uint64_t> parse_bytes(std::string_view text) {
  constexpr std::string_view units = "KMGT";
  double bytes = 0.0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), bytes, std::chars_format::fixed);
  const std::string_view rest(end, text.data() + text.size());
  const std::size_t unit = rest.size() == 1 ? units.find(rest[0]) : std::string_view::npos;
  if (error != std::errc() || unit == std::string_view::npos) return std::nullopt;
  bytes = std::ldexp(bytes, 10 * (static_cast<int>(unit) + 1));
  if (!(bytes >= 1.0 && bytes < 1e18)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace becalm::app
