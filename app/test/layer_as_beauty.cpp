#include "app/test/layer_as_beauty.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "frame/error.h"
#include "frame/io/exr.h"

namespace becalm::app {
namespace {

[[noreturn]] void fail_without(const std::string& layer, const std::string& path) {
  std::vector<std::string> channels;
  for (const io::ExrDescription::Part& part : io::describe_exr(path).parts) {
    for (const io::ExrDescription::Channel& channel : part.channels) channels.push_back(channel.name);
  }
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: no layer {}; channels found: {}", path, layer, fmt::join(channels, ", ")));
}

}  // namespace

PlacedFrame read_layer_as_beauty(const std::string& path, int number, const std::string& layer) {
  const std::optional<Aov> aov = layer.empty() ? Aov::beauty : find_aov(layer);
  io::LayerOptions options;
  if (!aov) options.layers[Aov::beauty] = layer;  // one of another renderer
  io::LoadedFrame file = io::read_exr(path, number, AovSet().set(), options);
  Frame& frame = file.frame;
  const auto placed = [&] {
    const auto rounding = [&](Aov of) { return file.rounding[static_cast<std::size_t>(of)]; };
    return PlacedFrame{std::move(frame), file.window.min, rounding(Aov::beauty), rounding(Aov::variance)};
  };
  if (!aov || *aov == Aov::beauty) return placed();
  if (!frame.has(*aov)) fail_without(layer, path);
  const Image& image = frame.image(*aov);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = c < image.channels() ? image.at(x, y, c) : 0.0f;
        const bool hits_nothing = *aov == Aov::depth && value == std::numeric_limits<float>::infinity();
        beauty.at(x, y, c) = hits_nothing ? 0.0f : value;
      }
    }
  }
  return placed();
}

}  // namespace becalm::app
