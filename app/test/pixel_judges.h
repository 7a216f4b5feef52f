#pragma once

#include "app/test/layer_as_beauty.h"
#include "app/test/suite.h"
#include "app/test/test_results.h"

namespace becalm::app {

/// Every channel of every part that the reference has, bit for bit or within max_ulps, and the windows. Other
/// metadata and what the reference lacks do not count.
CheckResult judge_exactly(const ExactJudge& judge, const JudgedFrame& files);

/// Frames of few samples against a reference of many. The suite's false-alarm rate is shared by the frames of
/// the case. Throws Error(bad_input) for a reference without variance.
CheckResult judge_statistically(const TestCase& test, const JudgedFrame& files, const PlacedFrame& fresh,
                                const PlacedFrame& reference, const PlacedFrame* reference_b);

}  // namespace becalm::app
