#pragma once

#include <string_view>

#include "frame/frame.h"

namespace becalm::filter {

/// Throws Error(bad_input), naming the frame, if it is not of this size or lacks one of the AOVs. `others` is
/// what the message compares it with: "the frames before it".
void check_frame(const Frame& frame, int width, int height, const AovSet& required, std::string_view others);

}  // namespace becalm::filter
