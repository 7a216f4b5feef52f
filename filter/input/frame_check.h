#pragma once

#include <string_view>

#include "frame/frame.h"

namespace becalm::filter {

/// Throws Error(bad_input), naming the frame, if it has another size or lacks a required AOV. `others` names
/// what the message compares it with, such as "the frames before it".
void check_frame(const Frame& frame, int width, int height, const AovSet& required, std::string_view others);

}  // namespace becalm::filter
