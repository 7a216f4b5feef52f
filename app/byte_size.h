#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace becalm::app {

/// The bytes of a size with its unit, such as 512M or 1.5G; nothing for another text.
std::optional<std::uint64_t> parse_bytes(std::string_view text);

}  // namespace becalm::app
