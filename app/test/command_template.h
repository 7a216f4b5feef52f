#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace becalm::app {

/// A program and its arguments, with placeholders such as {output}.
using CommandTemplate = std::vector<std::string>;

bool has_placeholder(const CommandTemplate& command, std::string_view name);
/// The same of a command or one of those that run before it.
bool any_has_placeholder(const CommandTemplate& command, const std::vector<CommandTemplate>& prepare,
                         std::string_view name);

/// Every placeholder of a list of (name in braces, value) replaced, wherever it stands in a word.
std::vector<std::string> substituted(CommandTemplate command,
                                     const std::vector<std::pair<std::string_view, std::string>>& values);

}  // namespace becalm::app
