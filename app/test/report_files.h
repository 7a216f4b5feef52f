#pragma once

#include <string>

#include "app/test/test_results.h"

namespace becalm::app {

/// JUnit's XML as CI systems read it: a testsuite for each suite file, with counts and times.
std::string junit_xml(const TestResults& results);

/// Everything of the results but the files of frames.
std::string results_json(const TestResults& results);

}  // namespace becalm::app
