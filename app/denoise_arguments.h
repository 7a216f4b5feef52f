#pragma once

#include "app/sequence_arguments.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
}  // namespace CLI

namespace becalm::app {

void add_denoise_options(CLI::App& parser, SequenceCommand& command);

}  // namespace becalm::app
