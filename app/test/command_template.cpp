#include "app/test/command_template.h"

#include <algorithm>

namespace becalm::app {
namespace {

void replace_all(std::string& text, std::string_view name, const std::string& value) {
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + value.size())) {
    text.replace(at, name.size(), value);
  }
}

}  // namespace

bool has_placeholder(const CommandTemplate& command, std::string_view name) {
  return std::ranges::any_of(command,
                             [&](const std::string& word) { return word.find(name) != std::string::npos; });
}

bool any_has_placeholder(const CommandTemplate& command, const std::vector<CommandTemplate>& prepare,
                         std::string_view name) {
  return has_placeholder(command, name) || std::ranges::any_of(prepare, [&](const CommandTemplate& step) {
           return has_placeholder(step, name);
         });
}

std::vector<std::string> substituted(CommandTemplate command,
                                     const std::vector<std::pair<std::string_view, std::string>>& values) {
  for (std::string& word : command) {
    for (const auto& [name, value] : values) replace_all(word, name, value);
  }
  return command;
}

}  // namespace becalm::app
