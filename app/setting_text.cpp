#include "app/setting_text.h"

#include <sstream>

namespace becalm::app {

std::vector<std::pair<std::string, std::string>> parse_settings(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> settings;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto equals = word.find('=');
    settings.emplace_back(word.substr(0, equals), equals == std::string::npos ? "" : word.substr(equals + 1));
  }
  return settings;
}

std::string setting_value(const std::string& text, const std::string& key) {
  for (const auto& [found, value] : parse_settings(text)) {
    if (found == key) return value;
  }
  return {};
}

}  // namespace becalm::app
