#pragma once

#include <string>
#include <utility>
#include <vector>

namespace becalm::app {

/// Keys and values of a text such as `spp=4 seed=1`, the attribute becalm:settings, in its order. A word
/// without `=` has no value.
std::vector<std::pair<std::string, std::string>> parse_settings(const std::string& text);

/// The value of a key; empty if it has none.
std::string setting_value(const std::string& text, const std::string& key);

}  // namespace becalm::app
