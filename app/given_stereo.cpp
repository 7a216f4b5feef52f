#include "app/given_stereo.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "frame/error.h"

namespace becalm::app {

GivenStereo given_stereo(const std::string& text) {
  constexpr std::string_view planar = ",planar";
  GivenStereo given;
  std::string_view rest = text;
  given.planar = rest.ends_with(planar);
  if (given.planar) rest.remove_suffix(planar.size());
  std::array<double, 3> numbers{};
  bool is_whole = true;
  for (std::size_t i = 0; i < numbers.size() && is_whole; ++i) {
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), numbers[i]);
    is_whole = error == std::errc() && std::isfinite(numbers[i]) && numbers[i] > 0.0;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    if (i + 1 == numbers.size() || !is_whole) continue;
    is_whole = rest.starts_with(',');
    if (is_whole) rest.remove_prefix(1);
  }
  if (!is_whole || !rest.empty()) {
    throw Error(
        ExitStatus::usage,
        fmt::format("--stereo-camera {}: expected FOCAL_PX,SEPARATION,CONVERGENCE, all above 0, such as "
                    "1200,0.065,2, and ,planar where depths are along the view",
                    text));
  }
  given.camera = {.focal_px = numbers[0], .separation = numbers[1], .convergence = numbers[2]};
  return given;
}

void give_stereo(const GivenStereo& given, Eye eye, io::LoadedView& loaded) {
  Frame& frame = loaded.frame;
  const StereoView view{.camera = given.camera, .eye = eye, .middle_px = loaded.middle_px};
  frame.set_stereo(view);
  if (!given.planar || !frame.has(Aov::depth)) return;
  Image& depth = frame.image(Aov::depth);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      float& z = depth.at(x, y, 0);
      z = static_cast<float>(z / view.cosine(x + 0.5, y + 0.5, depth.width(), depth.height()));
    }
  }
}

}  // namespace becalm::app
