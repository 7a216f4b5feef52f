#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frame/image.h"

namespace becalm::app {

/// Bytes of sRGB for people to look at.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Radiance times `exposure`, clamped to [0,1], with the sRGB curve; cyan where it is not finite. One channel
/// is grey.
Picture display_picture(const Image& image, double exposure = 1.0);
/// The factor that makes the brightest twentieth of the image white or nearly so; 1 for a black image.
double automatic_exposure(const Image& image);

/// Relative squared error of each pixel, as rel_mse has it, on a logarithmic scale from black by red to
/// white; cyan where it is not finite.
Picture error_picture(const Image& test, const Image& reference);
/// The ends of that scale, and its colours as CSS has them, separated by commas.
inline constexpr double kCoolestError = 1e-5;
inline constexpr double kHottestError = 10.0;
std::string error_scale_css();

/// Differences in standard deviations, the largest of a pixel's channels: dark for 0, red for brighter and
/// blue for darker, full at kLargestScore; green where it is not finite.
Picture score_picture(const Image& scores);
inline constexpr double kLargestScore = 8.0;
std::string score_scale_css();

/// A PNG file's. Throws Error(resource).
std::vector<unsigned char> png_bytes(const Picture& picture);

}  // namespace becalm::app
