#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tracer/math/vec.h"
#include "tracer/scene/texture.h"

namespace becalm::tracer {

/// Opacity over a surface: an image of 8-bit numbers in memory, looked up while rays are traced. Without MIP
/// levels: the samples of a pixel average over texels below its size.
class AlphaMask {
 public:
  /// Reads one channel of the image: `content` r, g, b or a; `color` stands for the alpha channel, or the
  /// luminance where there is none. Numbers count as they are in the file, clamped to [0,1]; NaN is 0. Throws
  /// std::runtime_error with the reason if it cannot be read or has no such channel.
  static AlphaMask read(const std::string& path, TextureContent content, const PicturePlacement& placement);

  /// In [0,1], between the four texels around uv; the picture repeats. 0 where uv is not finite. May be
  /// called by any number of threads.
  float opacity(const V2f& uv) const;

 private:
  int width_ = 0;
  int height_ = 0;
  PicturePlacement placement_;
  std::vector<std::uint8_t> texels_;  ///< rows from the top
};

}  // namespace becalm::tracer
