#pragma once

#include <string>
#include <vector>

#include "app/test/suite.h"
#include "app/test/work_folder.h"

namespace becalm::app {

/// Runs a case with the seeds from the source's on, and proposes limits that a further seed passes but for
/// the case's false-alarm rate, shared by its limits: lines for people, the last ones a "judged_by" to copy.
/// Logarithms of errors count as normally distributed, and the limit is the bound of Student's prediction
/// interval. Throws Error(bad_input) where a run could not be judged, and Error(interrupted).
std::vector<std::string> calibrate(const TestCase& test, int seeds, const WorkFolder& folder, int threads,
                                   bool reproducible);

}  // namespace becalm::app
