#pragma once

#include <string>
#include <vector>

#include "app/test/suite.h"
#include "app/test/work_folder.h"

namespace becalm::app {

/// Runs a case with `seeds` consecutive seeds, the source's first, and proposes limits: the probability that
/// one more seed exceeds any of them is the case's false-alarm rate, split among the limits. Returns lines
/// for people; the last one, if there are limits, is a "judged_by" to copy. Logarithms of errors count as
/// normally distributed, and a limit is the bound of Student's prediction interval. Throws Error(bad_input)
/// if a run could not be judged, and Error(interrupted).
std::vector<std::string> calibrate(const TestCase& test, int seeds, const WorkFolder& folder, int threads,
                                   bool reproducible);

}  // namespace becalm::app
