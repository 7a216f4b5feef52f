#include "frame/audit/pixels.h"

#include <array>
#include <cmath>
#include <utility>

namespace becalm::audit {
namespace {

constexpr float kSeenStep = 0.02f;
constexpr std::array<std::pair<int, int>, 4> kDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};

}  // namespace

std::vector<float> brightness(const Image& image) {
  std::vector<float> values(image.pixel_count());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto pixel = image.data().subspan(i * image.channels(), 3);
    const float mean = (pixel[0] + pixel[1] + pixel[2]) / 3.0f;
    values[i] = std::isfinite(mean) ? mean : 0.0f;
  }
  return values;
}

std::optional<double> rough_share(const Image& beauty) {
  const std::vector<float> values = brightness(beauty);
  const int width = beauty.width();
  std::size_t lit = 0;
  std::size_t rough = 0;
  for (int y = 1; y + 1 < beauty.height(); ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(y) * width + x;
      const float own = values[at];
      if (!(own > 0.0f)) continue;
      ++lit;
      bool reverses = true;
      for (const auto& [dx, dy] : kDirections) {
        const std::ptrdiff_t away = static_cast<std::ptrdiff_t>(dy) * width + dx;
        const float forward = own - values[at + away];
        const float backward = own - values[at - away];
        const bool seen = std::abs(forward) > kSeenStep * own && std::abs(backward) > kSeenStep * own;
        reverses = reverses && seen && (forward > 0.0f) == (backward > 0.0f);
      }
      if (reverses) ++rough;
    }
  }
  if (lit == 0) return std::nullopt;
  return static_cast<double>(rough) / static_cast<double>(lit);
}

std::vector<float> fine_detail(const Image& beauty) {
  const std::vector<float> values = brightness(beauty);
  const int width = beauty.width();
  std::vector<float> detail(values.size());
  for (int y = 1; y + 1 < beauty.height(); ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * width + x;
      float sum = 0.0f;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u) sum += values[at + static_cast<std::ptrdiff_t>(v) * width + u];
      }
      detail[at] = values[at] - sum / 9.0f;
    }
  }
  return detail;
}

}  // namespace becalm::audit
