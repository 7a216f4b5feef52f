#pragma once

#include <functional>

#include "frame/error.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace becalm::app {

/// A subcommand: its options, and what runs once they are parsed. `run` throws Error, gpu::DeviceError or
/// std::bad_alloc; `main` alone catches.
struct Command {
  CLI::App* parser;
  std::function<ExitStatus()> run;
};

/// Each adds one subcommand with its options and help to the command line.
Command add_render(CLI::App& becalm);
Command add_denoise(CLI::App& becalm);
Command add_antialias(CLI::App& becalm);
Command add_burst(CLI::App& becalm);
Command add_compare(CLI::App& becalm);
Command add_info(CLI::App& becalm);
Command add_test(CLI::App& becalm);

}  // namespace becalm::app
