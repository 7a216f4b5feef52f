#pragma once

#include <optional>
#include <string>

#include "frame/jitter.h"
#include "frame/scale.h"

namespace becalm::app {

/// `--jitter none` or `halton:N`: where the samples of a frame lie. Throws Error(usage) for another text.
std::optional<FrameJitter> given_jitter(const std::string& text, int frame);

/// `--checkerboard even` or `odd`: the pixels that hold the samples of a frame whose first pixel lies at
/// `first`. Frames of even numbers have the pixels that the option names, those of odd numbers the others.
Parity given_checkerboard(const std::string& text, int frame, const Imath::V2i& first);

/// `--scale 1.5`, `3/2` or `2`. Throws Error(usage) for another text and for what is not in 1 to 4.
Scale given_scale(const std::string& text);

}  // namespace becalm::app
