#pragma once

#include <functional>
#include <vector>

#include "app/test/suite.h"
#include "app/test/test_results.h"
#include "app/test/work_folder.h"

namespace becalm::app {

struct SuiteRunOptions {
  int jobs = 1;     ///< cases side by side
  int threads = 1;  ///< of each
  bool fail_fast = false;
  bool reproducible = false;  ///< the cases of scenes, by becalm's --reproducible
};

/// Runs the cases and calls `ended` with each result, one call at a time. Skips the remaining cases once
/// becalm is asked to stop, after the first that did not pass if `fail_fast`, and after an exception, which
/// is thrown again at the end.
TestResults run_cases(const std::vector<TestCase>& cases, const WorkFolder& folder,
                      const SuiteRunOptions& options, const std::function<void(const CaseResult&)>& ended);

}  // namespace becalm::app
