#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/additive_choice.h"
#include "frame/io/layers.h"

namespace becalm::app {

/// What Blender rendered, beside what it denoised itself.
struct NoisyImage {
  std::string layer;     ///< `ViewLayer.Noisy Image`
  std::string denoised;  ///< `ViewLayer.Combined`

  /// For the user to read.
  std::string text() const;
};

/// Makes the noisy image the beauty that `layers` names, if there is one beside the layer `Combined` that
/// would be the beauty, and returns it. Nothing if both are equal, since Blender has not denoised then (up to
/// 2.92 it wrote the layer for other denoisers, too), if becalm has denoised `Combined`, or if `layers` names
/// the beauty. The first frame that
/// is not black and can be read decides, so that all jobs of a shot choose alike.
std::optional<NoisyImage> take_noisy_image(const std::vector<NumberedFile>& files, io::LayerOptions& layers);

}  // namespace becalm::app
