#pragma once

#include "app/test/suite.h"
#include "tracer/scene/load/json_reader.h"

namespace becalm::app {

/// Changes `judges`, which are the suite's defaults, as a case's "judged_by" says: a judge that is named
/// replaces the default, `false` removes it. Throws Error(bad_input) at the value that is wrong.
void read_judges(const tracer::JsonValue& json, Judges& judges);

/// Throws where judges contradict each other, or the frames do not suffice for them.
void check_judges(const tracer::JsonValue& json, const TestCase& test);

}  // namespace becalm::app
