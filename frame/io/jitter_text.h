#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "frame/jitter.h"
#include "frame/scale.h"

namespace becalm::io {

/// The text attribute of jittered frames.
inline constexpr const char* kJitterAttribute = "becalm:jitter";

/// Such as `blackman_harris 1.5: 0.25 -0.125`: the pixel filter, its radius, and the positions of the
/// samples, joined by commas.
std::string format_jitter(const FrameJitter& jitter);

/// Nothing for a text that is not of that form.
std::optional<FrameJitter> parse_jitter(std::string_view text);

/// The text attribute of checkerboard frames: `even` or `odd`, the pixels whose x + y in the file's
/// coordinates is so hold samples.
inline constexpr const char* kCheckerboardAttribute = "becalm:checkerboard";

/// Nothing for another text. `first` is the frame's first pixel in the file's coordinates, to which the
/// result is relative.
std::optional<Parity> parse_checkerboard(std::string_view text, const Imath::V2i& first);

}  // namespace becalm::io
