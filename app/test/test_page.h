#pragma once

#include <string>

#include "app/test/test_results.h"

namespace becalm::app {

/// One HTML file without anything from elsewhere: cases that did not pass first, with their pictures. Reads
/// the frames' files; a file that cannot be read is a sentence in its place. Throws Error(resource).
std::string test_page(const TestResults& results);

}  // namespace becalm::app
