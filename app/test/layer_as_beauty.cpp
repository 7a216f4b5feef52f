#include "app/test/layer_as_beauty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "frame/error.h"
#include "frame/io/exr.h"

namespace becalm::app {

Frame read_layer_as_beauty(const std::string& path, int number, const std::string& layer) {
  const std::optional<Aov> aov = layer.empty() ? Aov::beauty : find_aov(layer);
  io::LayerOptions options;
  if (!aov) options.layers[Aov::beauty] = layer;  // one of another renderer
  Frame frame = io::read_exr(path, number, AovSet().set(), options).frame;
  if (!aov || *aov == Aov::beauty) return frame;
  if (!frame.has(*aov)) throw Error(ExitStatus::bad_input, fmt::format("{}: no layer {}", path, layer));
  const Image& image = frame.image(*aov);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = c < image.channels() ? image.at(x, y, c) : 0.0f;
        beauty.at(x, y, c) = std::isinf(value) ? 0.0f : value;  // the depth of what hits nothing
      }
    }
  }
  return frame;
}

}  // namespace becalm::app
