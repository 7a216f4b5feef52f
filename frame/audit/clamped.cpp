#include <fmt/format.h>

#include <algorithm>

#include "frame/audit/audit.h"
#include "frame/audit/pixels.h"

namespace becalm::audit {
namespace {

constexpr std::size_t kFewestPixels = 8;
constexpr double kSmallestShare = 1e-4;

/// Whether a neighbour has the same value, as on a lamp that is seen.
bool has_equal_neighbour(const std::vector<float>& values, int width, std::size_t at) {
  const std::size_t row = static_cast<std::size_t>(width);
  return (at % row > 0 && values[at - 1] == values[at]) ||
         (at % row + 1 < row && values[at + 1] == values[at]) ||
         (at >= row && values[at - row] == values[at]) ||
         (at + row < values.size() && values[at + row] == values[at]);
}

}  // namespace

std::optional<Finding> check_clamped(const Subject& subject) {
  const Image& beauty = subject.frame.image(Aov::beauty);
  const std::vector<float> values = brightness(beauty);
  const float largest = *std::ranges::max_element(values);
  if (!(largest > 0.0f)) return std::nullopt;
  std::size_t at_limit = 0;
  std::size_t alone = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] != largest) continue;
    ++at_limit;
    if (!has_equal_neighbour(values, beauty.width(), i)) ++alone;
  }
  const double share = static_cast<double>(at_limit) / static_cast<double>(values.size());
  if (at_limit < kFewestPixels || share < kSmallestShare || 2 * alone < at_limit) return std::nullopt;
  return Finding{
      "clamped",
      fmt::format("{} pixels apart from each other ({:.2g} %) all have the largest value, {:.4g}: bright "
                  "samples were clamped, and light is missing; render without a clamp",
                  at_limit, 100.0 * share, largest)};
}

}  // namespace becalm::audit
