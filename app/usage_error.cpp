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
    if (option->get_group().empty()) continue;  // hidden
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

/// What to type in place of the frames of a sequence.
std::string several_frames(const std::string& sequence) {
  return fmt::format("several frames of one sequence, which is one argument in quotes: '{}'", sequence);
}

/// The sequence that all of the words are frames of, as the shell makes them of `shot.*.exr`; empty if they
/// are none.
std::string sequence_of_all(std::span<const std::string> words) {
  const auto is_frame = [](const std::string& word) {
    std::error_code error;
    return io::frame_in_name(word) && std::filesystem::exists(word, error);
  };
  if (!std::ranges::all_of(words, is_frame)) return "";
  const std::vector<std::string> patterns = io::patterns_of_files(words);
  return patterns.size() == 1 ? patterns.front() : "";
}

}  // namespace

void refuse_too_many_values(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const auto most = static_cast<std::size_t>(option->get_items_expected_max());
    if (option->get_positional()) {
      if (option->count() <= most) continue;
      const std::string sequence = sequence_of_all(option->results());
      throw CLI::ValidationError(option->get_option_text(),
                                 sequence.empty()
                                     ? fmt::format("are {} words, expected {} at most", option->count(), most)
                                     : several_frames(sequence));
    }
    const bool takes_one_value = !option->get_option_text().empty() && most <= 1;
    if (!takes_one_value || option->count() <= 1) continue;
    throw CLI::ValidationError(option->get_name(),
                               fmt::format("is given {} times, expected once", option->count()));
  }
}

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
    return prefix + several_frames(sequence);
  }
  return fmt::format("{}unknown option or argument: {}{}; see {}", prefix, fmt::join(unknown, " "),
                     guess(unknown, becalm, command, arguments), help);
}

}  // namespace becalm::app
