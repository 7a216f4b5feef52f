#pragma once

#include <optional>
#include <string>

#include "frame/jitter.h"

namespace becalm::app {

/// `--jitter none` or `halton:N`: where the samples of a frame lie. Throws Error(usage) for another text.
std::optional<FrameJitter> given_jitter(const std::string& text, int frame);

}  // namespace becalm::app
