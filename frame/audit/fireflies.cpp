#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "frame/audit/audit.h"
#include "frame/audit/pixels.h"

namespace becalm::audit {
namespace {

constexpr float kTimesNeighbours = 20.0f;
constexpr double kLargestShareOfLight = 0.05;

/// The middle of the eight neighbours of a pixel that is not at the border.
float median_around(const std::vector<float>& values, int width, std::ptrdiff_t at) {
  std::array<float, 8> around{};
  std::size_t count = 0;
  for (int v = -1; v <= 1; ++v) {
    for (int u = -1; u <= 1; ++u) {
      if (u != 0 || v != 0) around[count++] = values[at + static_cast<std::ptrdiff_t>(v) * width + u];
    }
  }
  std::ranges::nth_element(around, around.begin() + 4);
  return around[4];
}

}  // namespace

std::optional<Finding> check_fireflies(const Subject& subject) {
  const Image& beauty = subject.frame.image(Aov::beauty);
  const std::vector<float> values = brightness(beauty);
  double all = 0.0;
  for (const float value : values) all += std::max(value, 0.0f);
  double in_fireflies = 0.0;
  std::size_t count = 0;
  for (int y = 1; y + 1 < beauty.height(); ++y) {
    for (int x = 1; x + 1 < beauty.width(); ++x) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(y) * beauty.width() + x;
      const float around = median_around(values, beauty.width(), at);
      if (!(around > 0.0f) || values[at] < kTimesNeighbours * around) continue;
      in_fireflies += values[at];
      ++count;
    }
  }
  if (!(in_fireflies > kLargestShareOfLight * all)) return std::nullopt;
  return Finding{
      "fireflies",
      fmt::format("{:.0f} % of the light is in {} single bright pixels, whose share no filter can place: "
                  "more samples, or a renderer's option for caustics, help more than denoising",
                  100.0 * in_fireflies / all, count)};
}

}  // namespace becalm::audit
