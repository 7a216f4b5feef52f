#pragma once

#include <string>
#include <vector>

#include "frame/frame.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// What became of a frame's alpha, as outputs record it: `passed on`, or `denoised in 12 of 96 pixels`, those
/// of all views. Empty where the source has none.
std::string alpha_outcome(const io::LoadedFrame& source, const Frame& denoised,
                          const std::vector<Frame>& other_views);

/// For `info`: what denoise does with the alpha of the file's default view. Empty where there is none, or no
/// colour, or pixels that cannot be read.
std::string alpha_outlook(const std::string& path, const io::LayerOptions& layers);

}  // namespace becalm::app
