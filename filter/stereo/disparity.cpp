#include "filter/stereo/disparity.h"

#include <algorithm>
#include <cmath>

#include "filter/ceil_div.h"
#include "filter/for_rows.h"

namespace becalm::filter {
namespace {

constexpr float kNoMotion = 1e30f;  // of shaders/lib/motion.glsl

}  // namespace

Image expected_in_other(const Frame& frame, float limit_px) {
  const Image& depth = frame.image(Aov::depth);
  const std::optional<StereoView>& view = frame.stereo();
  const int width = frame.width();
  Image expected(width, frame.height(), 2);
  for_rows(frame.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        const double along_ray = depth.at(x, y, 0);
        float& offset = expected.at(x, y, 0) = kNoMotion;
        if (!(along_ray > 0.0)) continue;  // NaN, or no depth
        expected.at(x, y, 1) = static_cast<float>(along_ray);
        if (!view) continue;
        const double z = along_ray * view->cosine(x + 0.5, y + 0.5, width, frame.height());
        const double there = view->offset_to_other_px(z);
        if (!(std::abs(there) <= limit_px)) continue;
        offset = static_cast<float>(there);
        const StereoView other{view->camera, view->other_eye()};
        expected.at(x, y, 1) =
            static_cast<float>(z / other.cosine(x + 0.5 + there, y + 0.5, width, frame.height()));
      }
    }
  });
  return expected;
}

Image block_means(const Image& image, int scale) {
  const int channels = image.channels();
  Image means(ceil_div(image.width(), scale), ceil_div(image.height(), scale), channels);
  for_rows(means.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const int y1 = std::min((y + 1) * scale, image.height());
      for (int x = 0; x < means.width(); ++x) {
        const int x1 = std::min((x + 1) * scale, image.width());
        const float share = 1.0f / static_cast<float>((y1 - y * scale) * (x1 - x * scale));
        for (int v = y * scale; v < y1; ++v) {
          for (int u = x * scale; u < x1; ++u) {
            for (int c = 0; c < channels; ++c) means.at(x, y, c) += share * image.at(u, v, c);
          }
        }
      }
    }
  });
  return means;
}

Image upsampled_offsets(const Image& of_blocks, int scale, int width, int height) {
  Image offsets(width, height, 2);
  const auto taps = [&](int at, int last, int& lo, int& hi) {
    const float place = (static_cast<float>(at) + 0.5f) / static_cast<float>(scale) - 0.5f;
    const float base = std::floor(place);
    lo = std::clamp(static_cast<int>(base), 0, last);
    hi = std::clamp(static_cast<int>(base) + 1, 0, last);
    return place - base;
  };
  for_rows(height, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      int y0 = 0, y1 = 0;
      const float v = taps(y, of_blocks.height() - 1, y0, y1);
      for (int x = 0; x < width; ++x) {
        int x0 = 0, x1 = 0;
        const float u = taps(x, of_blocks.width() - 1, x0, x1);
        for (int c = 0; c < 2; ++c) {
          const float top = std::lerp(of_blocks.at(x0, y0, c), of_blocks.at(x1, y0, c), u);
          const float bottom = std::lerp(of_blocks.at(x0, y1, c), of_blocks.at(x1, y1, c), u);
          offsets.at(x, y, c) = static_cast<float>(scale) * std::lerp(top, bottom, v);
        }
      }
    }
  });
  return offsets;
}

}  // namespace becalm::filter
