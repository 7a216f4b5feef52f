#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace becalm::app {

/// The words of a text in lines of at most `width` characters.
std::string wrap(const std::string& text, std::size_t width);

/// The group of the options that belong to `group` and that --help leaves out, so that it fits a screen.
std::string more(const std::string& group);

/// Adds --help-all, which prints the options of every group.
void add_help_all(CLI::App& command);

/// Help that fits 100 columns: a usage line with what is required, then the options by group. What an option
/// takes is its `option_text`.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;

 protected:
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override;
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace becalm::app
