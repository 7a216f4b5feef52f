#include "filter/input/motion_to_next.h"

#include <cmath>
#include <limits>
#include <vector>

namespace becalm::filter {

Image motion_to_next(const Frame& next) {
  const Image& motion = next.image(Aov::motion);
  const Image& depth = next.image(Aov::depth);
  const int width = motion.width();
  const int height = motion.height();
  const bool known = next.jitter() && next.jitter()->positions_px.size() == 1;
  const Imath::V2f position = known ? next.jitter()->positions_px.front() : Imath::V2f(0.0f);
  Image result(width, height, 2, std::numeric_limits<float>::quiet_NaN());
  std::vector<float> closest(motion.pixel_count(), std::numeric_limits<float>::infinity());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float dx = motion.at(x, y, 0);
      const float dy = motion.at(x, y, 1);
      const float at_x = std::round(static_cast<float>(x) + position.x + dx);
      const float at_y = std::round(static_cast<float>(y) + position.y + dy);
      // False for NaN too.
      if (!(at_x >= 0.0f && at_y >= 0.0f && at_x < static_cast<float>(width) &&
            at_y < static_cast<float>(height)))
        continue;
      const auto to = static_cast<std::size_t>(at_y) * width + static_cast<std::size_t>(at_x);
      const float z = depth.empty() || !(depth.at(x, y, 0) > 0.0f) ? std::numeric_limits<float>::infinity()
                                                                   : depth.at(x, y, 0);
      if (!std::isnan(result.data()[2 * to]) && !(z < closest[to])) continue;
      closest[to] = z;
      result.data()[2 * to] = -dx;
      result.data()[2 * to + 1] = -dy;
    }
  }
  return result;
}

}  // namespace becalm::filter
