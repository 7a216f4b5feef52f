// The command line: parses, runs one subcommand and turns every failure into one line and an exit status.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/cancel.h"
#include "app/command.h"
#include "app/console.h"
#include "app/help.h"
#include "app/usage_error.h"
#include "filter/gpu/device.h"
#include "frame/error.h"

namespace {

using becalm::ExitStatus;

constexpr const char* kDescription =
    "becalm renders animations with few samples per pixel and makes them calm.";

constexpr const char* kFooter =
    "Examples:\n"
    "  becalm render room.json -o 'noisy/room.####.exr' --frames 1-24 --spp 8 --aovs all\n"
    "  becalm denoise 'noisy/room.####.exr' -o 'calm/room.####.exr'\n"
    "  becalm render room.json -o 'calm/room.####.exr' --spp 8 --denoise\n"
    "  becalm antialias 'jittered/room.####.exr' -o 'smooth/room.####.exr'\n"
    "  becalm burst IMG_*.dng -o night.exr\n"
    "  becalm compare 'reference/room.####.exr' 'calm/room.####.exr' --report report\n"
    "  becalm info device\n"
    "  becalm test suite.json --junit results.xml\n"
    "\n"
    "Quote patterns such as 'room.####.exr'. Results go to files, data to standard output, progress and\n"
    "messages to standard error.\n"
    "Exit status: 0 done; 1 a comparison or a test failed; 2 wrong usage; 3 bad input; 4 device or resource "
    "trouble;\n"
    "130 interrupted, 129 by a hang-up.\n"
    "becalm COMMAND --help tells a command's options, and --help-all all of them.\n";

int fail(ExitStatus status, const std::string& message) {
  becalm::app::say_error(status, message);
  return becalm::app::process_status(status);
}

/// The system's own what() has no path where the working directory is gone.
std::string describe(const std::filesystem::filesystem_error& error) {
  std::error_code missing;
  const std::filesystem::path folder = std::filesystem::current_path(missing);
  if (folder.empty())
    return fmt::format("the working directory: {}; change to one that is there", missing.message());
  return fmt::format("unexpected: {}", error.what());
}

/// Flushes standard output. The status tells if it could not be written.
int finish_output(int status) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  return fail(ExitStatus::resource, "standard output cannot be written to");
}

/// The command that the user typed; null: none.
const becalm::app::Command* find_chosen(std::span<const becalm::app::Command> commands) {
  const auto chosen = std::ranges::find_if(
      commands, [](const becalm::app::Command& command) { return command.parser->parsed(); });
  return chosen == commands.end() ? nullptr : &*chosen;
}

/// Padded numbers, as those of frames are, stay decimal: CLI11 takes a leading zero for octal.
void allow_padded_numbers(CLI::App& parser) {
  for (CLI::Option* option : parser.get_options()) {
    const std::string type = option->get_type_name();  // and the range of those that have one
    if (!type.starts_with("INT") && !type.starts_with("UINT")) continue;
    option->transform([](const std::string& text) {
      const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
      std::size_t first = sign;  // digit that counts
      const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
      while (first + 1 < text.size() && text[first] == '0' && is_digit(text[first + 1])) ++first;
      return text.substr(0, sign) + text.substr(first);
    });
  }
}

/// An empty value, as of a script's variable that is not set, is a mistake and not the default.
void refuse_empty_values(CLI::App& parser) {
  const auto check = [](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); };
  for (CLI::Option* option : parser.get_options()) {
    if (option->get_type_name() == "TEXT") option->check(check);
  }
}

/// The same behind an equals sign: CLI11 takes the default of a flag for the value of `--update=`, and the
/// next word for that of `--filter=`.
void refuse_empty_assignments(const CLI::App& command, std::span<const std::string> arguments) {
  for (const std::string& word : arguments) {
    if (word == "--") return;  // no options follow
    if (!word.ends_with('=')) continue;
    const std::string name = word.substr(0, word.size() - 1);
    if (command.get_option_no_throw(name) != nullptr) throw CLI::ValidationError(name, "is empty");
  }
}

/// What --progress says, known before anything can be wrong with the other options.
becalm::app::MessageFormat asked_format(std::span<const std::string> arguments) {
  constexpr std::string_view option = "--progress";
  std::string_view value;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view word = arguments[i];
    if (word == option && i + 1 < arguments.size()) value = arguments[i + 1];
    if (word.starts_with(option) && word.substr(option.size()).starts_with('='))
      value = word.substr(option.size() + 1);
  }
  return value == "json" ? becalm::app::MessageFormat::json : becalm::app::MessageFormat::text;
}

/// `becalm help`, as other programs of many commands have it, asks for --help, and `becalm help COMMAND` for
/// that command's. An unknown COMMAND stays alone, so that it is told.
std::vector<std::string> without_help_command(const std::vector<std::string>& typed,
                                              std::span<const becalm::app::Command> commands) {
  if (typed.empty() || typed.front() != "help") return typed;
  if (typed.size() == 1 || typed[1] == "help") return {"--help"};
  const bool is_known = std::ranges::any_of(
      commands, [&](const becalm::app::Command& command) { return command.parser->get_name() == typed[1]; });
  return is_known ? std::vector<std::string>{typed[1], "--help"} : std::vector<std::string>{typed[1]};
}

int run(const std::vector<std::string>& typed) {
  constexpr const char* version = "becalm " BECALM_VERSION;
  CLI::App parser(kDescription, "becalm");
  parser.footer(kFooter);
  parser.set_version_flag("--version", version, "Print the version and exit");
  parser.set_help_flag("-h,--help", "Print this help and exit");
  parser.formatter(std::make_shared<becalm::app::HelpFormatter>());
  parser.get_formatter()->column_width(30);
  parser.require_subcommand(1);
  // Another policy would be one of flags, too, which may be repeated: refuse_too_many_values has the rest.
  parser.option_defaults()->take_last();
  const std::array commands{becalm::app::add_render(parser),    becalm::app::add_denoise(parser),
                            becalm::app::add_antialias(parser), becalm::app::add_burst(parser),
                            becalm::app::add_compare(parser),   becalm::app::add_info(parser),
                            becalm::app::add_test(parser)};
  becalm::app::add_help_all(parser);
  for (const auto& command : commands) {
    becalm::app::add_help_all(*command.parser);
    command.parser->set_version_flag("--version", version)->group("");
    allow_padded_numbers(*command.parser);
    refuse_empty_values(*command.parser);
  }
  const std::vector<std::string> arguments = without_help_command(typed, commands);
  try {
    parser.parse(std::vector(arguments.rbegin(), arguments.rend()));  // CLI11 takes them from the end
    refuse_empty_assignments(*find_chosen(commands)->parser, arguments);
    becalm::app::refuse_too_many_values(*find_chosen(commands)->parser);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return finish_output(parser.exit(error));  // --help, --version
    const becalm::app::Command* chosen = find_chosen(commands);
    return fail(
        ExitStatus::usage,
        becalm::app::usage_message(error, parser, chosen == nullptr ? nullptr : chosen->parser, arguments));
  }
  return finish_output(becalm::app::process_status(find_chosen(commands)->run()));
}

}  // namespace

int main(int argc, char** argv) {
  becalm::app::occupy_closed_streams();
  try {
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    becalm::app::set_message_format(asked_format(arguments));
    return run(arguments);
  } catch (const becalm::Error& error) {
    return fail(error.status(), error.what());
  } catch (const becalm::gpu::DeviceError& error) {
    return fail(ExitStatus::resource, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitStatus::resource, "not enough memory; smaller pictures and fewer layers need less");
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(ExitStatus::resource, describe(error));
  } catch (const std::exception& error) {
    return fail(ExitStatus::resource, fmt::format("unexpected: {}", error.what()));
  }
}
