#pragma once

#include "tracer/procedural/description.h"
#include "tracer/scene/load/json_reader.h"

namespace becalm::tracer {

/// A mesh entry {"procedural": "terrain" | "ocean" | "blobs", ...}. Throws Error(bad_input) at the value that
/// is wrong.
ProceduralDescription read_procedural(const JsonValue& json);

}  // namespace becalm::tracer
