#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "frame/jitter.h"

namespace becalm::io {

/// The text attribute of jittered frames.
inline constexpr const char* kJitterAttribute = "becalm:jitter";

/// Such as `blackman_harris 1.5: 0.25 -0.125`: the pixel filter, its radius, and the positions of the
/// samples, joined by commas.
std::string format_jitter(const FrameJitter& jitter);

/// Nothing for a text that is not of that form.
std::optional<FrameJitter> parse_jitter(std::string_view text);

}  // namespace becalm::io
