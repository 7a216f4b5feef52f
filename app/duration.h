#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace becalm::app {

/// The seconds of a time such as 2s, 500ms, 1.5m or 1h; a number alone is in seconds. Nothing for another
/// text, and for times that are not positive.
std::optional<double> parse_duration(std::string_view text);

/// The seconds of an option's value. Throws Error(usage) that names the option.
double duration_of(std::string_view option, const std::string& text);

}  // namespace becalm::app
