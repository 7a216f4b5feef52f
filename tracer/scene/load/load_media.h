#pragma once

#include "tracer/scene/load/load_values.h"
#include "tracer/scene/medium_description.h"

namespace becalm::tracer {

/// A member of the scene file's "media". Throws Error(bad_input) at the JSON value that is wrong.
MediumDescription read_medium(const JsonValue& json);

}  // namespace becalm::tracer
