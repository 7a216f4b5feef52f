#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/additive_choice.h"
#include "frame/io/layers.h"

namespace becalm::app {

/// What a renderer has denoised itself, and what it was made from: `Combined` and `Noisy Image` (Blender),
/// `Beauty` or bare channels and `Beauty_Noisy` (Redshift).
struct NoisyImage {
  std::string layer;     ///< `ViewLayer.Noisy Image`
  std::string denoised;  ///< `ViewLayer.Combined`; `RGBA` for bare channels

  /// For the user to read.
  std::string text() const;
};

/// Makes the noisy image the beauty that `layers` names, if there is one beside the layer that would be the
/// beauty, and returns it. Nothing if both are equal, since the renderer has not denoised then (up to 2.92
/// Blender wrote the layer for other denoisers, too), if becalm has denoised the other, or if `layers` names
/// the beauty. The first frame that has both, is not black and can be read decides, so that all jobs of a
/// shot choose alike.
std::optional<NoisyImage> take_noisy_image(const std::vector<NumberedFile>& files, io::LayerOptions& layers);

}  // namespace becalm::app
