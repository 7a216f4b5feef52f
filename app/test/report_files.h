#pragma once

#include <string>

#include "app/test/test_results.h"

namespace becalm::app {

/// JUnit's XML as CI systems read it: a testsuite for each suite file, with counts and times.
std::string junit_xml(const TestResults& results);

/// Everything of the results but the files of frames.
std::string results_json(const TestResults& results);

/// Throws Error(resource) naming the option.
void write_report_file(const std::string& option, const std::string& path, const std::string& text);

}  // namespace becalm::app
