#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace becalm::app {

/// What becalm recorded about how it made a file: nothing for other files and damaged ones.
nlohmann::ordered_json origin_of(const std::string& path);

/// In words, or nothing.
std::vector<std::string> origin_lines(const nlohmann::ordered_json& origin);

}  // namespace becalm::app
