#pragma once

#include <optional>
#include <vector>

#include "frame/image.h"

namespace becalm::audit {

/// Mean of the first three channels; 0 where one of them is not finite.
std::vector<float> brightness(const Image& image);

/// Share of the lit pixels (brightness above 0, not at the border) that in each of the four directions are
/// brighter than both neighbours, or darker than both, by more than 2 % of their own brightness: about a
/// fifth in white noise, next to nothing in clean pictures. Nothing if no pixel is lit.
std::optional<double> rough_share(const Image& beauty);

/// Each pixel's brightness minus the mean of the 3x3 pixels around it; 0 at the border.
std::vector<float> fine_detail(const Image& beauty);

}  // namespace becalm::audit
