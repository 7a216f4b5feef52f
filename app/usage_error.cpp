#include "app/usage_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/nearest_name.h"
#include "frame/io/sequence.h"

namespace becalm::app {
namespace {

std::vector<std::string> names_of_options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> names_of_commands(const CLI::App& becalm) {
  std::vector<std::string> names;
  for (const CLI::App* command : becalm.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

/// `--denoise=final` where `--denoise final` was typed: a value that may be left out needs its equals sign.
std::string value_of_flag(const CLI::App& command, std::span<const std::string> arguments) {
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string& name = arguments[i - 1];
    const std::string& value = arguments[i];
    if (!name.starts_with("--") || value.starts_with('-')) continue;
    const CLI::Option* option = command.get_option_no_throw(name);
    std::error_code error;
    if (option == nullptr || !option->get_option_text().starts_with("[=")) continue;
    if (!std::filesystem::exists(value, error)) return name + '=' + value;
  }
  return "";
}

/// The sequence that all of the words are frames of, as the shell makes them of `shot.*.exr`; empty if they
/// are none.
std::string sequence_of_all(std::span<const std::string> words) {
  std::string sequence;
  for (const std::string& word : words) {
    std::error_code error;
    const std::string pattern = io::pattern_of_frame(word).value_or("");
    if (pattern.empty() || !std::filesystem::exists(word, error)) return "";
    if (!sequence.empty() && pattern != sequence) return "";
    sequence = pattern;
  }
  return sequence;
}

/// What was probably meant, in words that follow the unknown ones; empty where nothing is near.
std::string guess(const std::vector<std::string>& unknown, const CLI::App& becalm, const CLI::App* command,
                  std::span<const std::string> arguments) {
  const std::string& first = unknown.front();
  std::string meant;
  if (command == nullptr) {
    meant = nearest_name(first, names_of_commands(becalm));
  } else if (first.starts_with("--")) {
    meant = nearest_name(std::string_view(first).substr(0, first.find('=')), names_of_options(*command));
  } else {
    meant = value_of_flag(*command, arguments);
  }
  return meant.empty() ? "" : fmt::format(" (did you mean {}?)", meant);
}

}  // namespace

std::string usage_message(const CLI::ParseError& error, const CLI::App& becalm, const CLI::App* command,
                          std::span<const std::string> arguments) {
  const std::string name = command == nullptr ? "" : command->get_name();
  const std::string help = name.empty() ? "becalm --help" : fmt::format("becalm {} --help", name);
  const std::string prefix = name.empty() ? "" : name + ": ";
  const auto kind = static_cast<CLI::ExitCodes>(error.get_exit_code());
  const std::vector<std::string> unknown = becalm.remaining(/*recurse=*/true);
  const bool is_unknown = kind == CLI::ExitCodes::ExtrasError || kind == CLI::ExitCodes::RequiredError;
  if (unknown.empty() || !is_unknown) return fmt::format("{}{}; see {}", prefix, error.what(), help);
  if (const std::string sequence = sequence_of_all(unknown); !sequence.empty()) {
    return fmt::format("{}several frames of one sequence, which is one argument in quotes: '{}'", prefix,
                       sequence);
  }
  return fmt::format("{}unknown option or argument: {}{}; see {}", prefix, fmt::join(unknown, " "),
                     guess(unknown, becalm, command, arguments), help);
}

}  // namespace becalm::app
