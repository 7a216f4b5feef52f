#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>

namespace becalm::app {

/// What is wrong with a command line, on one line: CLI11's message with the command that it is about and
/// where its help is, or what is not known and what was probably meant. What is not known comes before what
/// is missing. `command` is null where none was recognised.
std::string usage_message(const CLI::ParseError& error, const CLI::App& becalm, const CLI::App* command,
                          std::span<const std::string> arguments);

/// Throws CLI::ValidationError if a parsed command has more words than its positional arguments take, of
/// which CLI11 would drop the first, or two values of one option, of which one is a mistake. Flags may be
/// repeated, and options that say so.
void refuse_too_many_values(const CLI::App& command);

}  // namespace becalm::app
