#pragma once

#include "app/test/judge_frames.h"
#include "app/test/make_frames.h"
#include "app/test/suite.h"
#include "app/test/test_results.h"

namespace becalm::app {

struct CaseRun {
  CaseResult result;
  bool judged = false;    ///< every frame could be measured; else `result` says why not
  Measurements measured;  ///< if judged
  bool interrupted = false;
};

/// Makes the frames of a case with the source's seed plus `seed_offset` and judges them. Never throws: what
/// goes wrong is the case's outcome.
CaseRun run_case(const TestCase& test, const RunSettings& settings, std::uint32_t seed_offset = 0);

}  // namespace becalm::app
