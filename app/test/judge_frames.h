#pragma once

#include <set>
#include <string>
#include <vector>

#include "app/frame_figures.h"
#include "app/test/suite.h"
#include "app/test/test_results.h"

namespace becalm::app {

/// What was measured of a case's frames. --calibrate proposes limits from it.
struct Measurements {
  std::vector<FrameFigures> frames;
  std::vector<FrameFigures> denoised_frames;  ///< empty unless judged denoised
  double temporal_error = 0.0;                ///< mean over all pairs of frames; NaN without a pair
  double flicker = 0.0;                       ///< NaN without a pair
};

struct Verdict {
  std::vector<CheckResult> checks;
  /// Why the frames could not be judged at all: unreadable, of another size, not finite. The case failed.
  std::vector<std::string> problems;
  std::set<int> unjudged;  ///< the numbers of these frames
  Measurements measured;
};

/// Reads the files of `frames` and judges them. Throws Error(bad_input) for a reference that is bad.
Verdict judge_frames(const TestCase& test, const std::vector<JudgedFrame>& frames);

}  // namespace becalm::app
