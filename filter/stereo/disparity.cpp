#include "filter/stereo/disparity.h"

#include <algorithm>
#include <cmath>

#include "filter/for_rows.h"

namespace becalm::filter {

Correspondence correspondence_by_depth(const Frame& frame, float limit_px) {
  const Image& depth = frame.image(Aov::depth);
  const StereoView& view = *frame.stereo();
  StereoView other = view;
  other.eye = view.other_eye();
  const int width = frame.width();
  const int height = frame.height();
  Correspondence where{Image(width, height, 2, kNowhere), Image(width, height, 1)};
  for_rows(height, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        const double along_ray = depth.at(x, y, 0);
        if (!(along_ray > 0.0)) continue;  // NaN, or no depth
        const double z = along_ray * view.cosine(x + 0.5, y + 0.5, width, height);
        const double offset = view.offset_to_other_px(z);
        if (!(std::abs(offset) <= limit_px)) continue;
        where.offset.at(x, y, 0) = static_cast<float>(offset);
        where.offset.at(x, y, 1) = 0.0f;
        where.depth.at(x, y, 0) =
            static_cast<float>(z / other.cosine(x + 0.5 + offset, y + 0.5, width, height));
      }
    }
  });
  return where;
}

Image consistent_offsets(const Image& offsets, const Image& back) {
  constexpr float kTolerance_px = 1.0f;
  Image consistent(offsets.width(), offsets.height(), 2, kNowhere);
  for_rows(offsets.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < offsets.width(); ++x) {
        const std::span<const float> there = offsets.pixel(x, y);
        const long u = std::lround(static_cast<float>(x) + there[0]);
        const long v = std::lround(static_cast<float>(y) + there[1]);
        if (u < 0 || v < 0 || u >= back.width() || v >= back.height()) continue;
        const std::span<const float> again = back.pixel(static_cast<int>(u), static_cast<int>(v));
        if (std::hypot(there[0] + again[0], there[1] + again[1]) > kTolerance_px) continue;
        std::ranges::copy(there, consistent.pixel(x, y).begin());
      }
    }
  });
  return consistent;
}

}  // namespace becalm::filter
