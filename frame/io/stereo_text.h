#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "frame/stereo.h"

namespace becalm::io {

/// The text attribute of a file, or of a part, that is of one eye.
inline constexpr const char* kStereoAttribute = "becalm:stereo";

/// Such as `left focal_px=1200 separation=0.065 convergence=2`.
std::string format_stereo(const StereoView& view);

/// Nothing for a text that is not of that form, or whose numbers are of no camera.
std::optional<StereoView> parse_stereo(std::string_view text);

}  // namespace becalm::io
