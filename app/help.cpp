#include "app/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>

namespace becalm::app {
namespace {

constexpr std::size_t kColumns = 100;

std::vector<const CLI::Option*> options_of(const CLI::App* app, const std::string& group, bool positional) {
  return app->get_options([&](const CLI::Option* option) {
    return option->get_positional() == positional && (positional || option->get_group() == group);
  });
}

constexpr std::string_view kMore = ", more";

bool is_more(std::string_view group) {
  return group.ends_with(kMore);
}

/// The groups that are headings, each once, in the order in which their first options were added. The
/// default group, "Options" with --help, comes last.
std::vector<std::string> headings_of(const CLI::App* app) {
  std::vector<std::string> headings;
  for (std::string group : app->get_groups()) {
    if (is_more(group)) group.resize(group.size() - kMore.size());
    if (std::ranges::find(headings, group) == headings.end()) headings.push_back(group);
  }
  std::rotate(headings.begin(), headings.begin() + 1, headings.end());
  return headings;
}

}  // namespace

std::string wrap(const std::string& text, std::size_t width) {
  std::string wrapped;
  std::size_t line = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (line > 0 && line + 1 + word.size() > width) {
      wrapped += '\n';
      line = 0;
    } else if (line > 0) {
      wrapped += ' ';
      ++line;
    }
    wrapped += word;
    line += word.size();
  }
  return wrapped;
}

std::string more(const std::string& group) {
  return group + std::string(kMore);
}

void add_help_all(CLI::App& command) {
  command.set_help_all_flag("--help-all", "Print every option and exit");
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  if (mode == CLI::AppFormatMode::Sub) name = "becalm " + app->get_name();  // CLI11 says the name twice
  std::string help = make_description(app) + "\n" + make_usage(app, std::move(name));
  if (const auto positionals = options_of(app, "", true); !positionals.empty()) {
    help += make_group("", true, positionals);
  }
  help += make_subcommands(app, mode);
  for (const std::string& heading : headings_of(app)) {
    std::vector<const CLI::Option*> options = options_of(app, heading, false);
    if (mode != CLI::AppFormatMode::Normal) {
      std::ranges::copy(options_of(app, more(heading), false), std::back_inserter(options));
    }
    if (!heading.empty() && !options.empty()) help += make_group(heading, false, options);
  }
  return help + "\n" + app->get_footer();
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const {
  std::string usage = "Usage: " + name;
  for (const CLI::Option* option :
       app->get_options([](const CLI::Option* o) { return o->get_positional(); })) {
    usage += ' ' + option->get_option_text();
  }
  for (const CLI::Option* option :
       app->get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
    // The one short option that takes a value is the output.
    if (!option->get_snames().empty() && !option->get_option_text().empty())
      usage += fmt::format(" -{} {}", option->get_snames().front(), option->get_option_text());
  }
  const bool has_commands = !app->get_subcommands([](const CLI::App*) { return true; }).empty();
  return usage + (has_commands ? " COMMAND [OPTIONS]\n" : " [OPTIONS]\n");
}

std::string HelpFormatter::make_group(std::string group, bool is_positional,
                                      std::vector<const CLI::Option*> options) const {
  std::string text = group.empty() ? "\n" : fmt::format("\n{}:\n", group);
  for (const CLI::Option* option : options) text += make_option(option, is_positional);
  return text;
}

std::string HelpFormatter::make_option_name(const CLI::Option* option, bool is_positional) const {
  if (is_positional) return option->get_option_text();
  const std::string name = option->get_name(false, true);
  return name.substr(0, name.find('{'));  // without the value that a flag gives
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  const std::string& takes = option->get_option_text();
  if (option->get_positional() || takes.empty()) return "";
  return takes.front() == '[' ? takes : ' ' + takes;
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  return wrap(option->get_description(), kColumns - column_width_);
}

}  // namespace becalm::app
