#pragma once

#include <optional>
#include <vector>

#include "frame/image.h"

namespace becalm::audit {

/// Mean of the first three channels; 0 where one of them is not finite.
std::vector<float> brightness(const Image& image);

/// Share of the lit pixels inside the border whose brightness is above or below that of all eight neighbours
/// on both sides, in all four directions, by more than 2 %: about a fifth of white noise, next to nothing of
/// clean pictures. Nothing where no such pixel is lit.
std::optional<double> rough_share(const Image& beauty);

/// Each pixel's brightness minus the mean of the 3x3 pixels around it; 0 at the border.
std::vector<float> fine_detail(const Image& beauty);

}  // namespace becalm::audit
