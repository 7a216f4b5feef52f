#include <fmt/format.h>

#include <cmath>

#include "frame/audit/audit.h"

namespace becalm::audit {
namespace {

constexpr double kTolerance = 0.1;
/// Pixels at edges and on rough surfaces average normals, which makes them shorter.
constexpr double kLargestShareOfOtherLength = 0.25;

}  // namespace

std::optional<Finding> check_normal_length(const Subject& subject) {
  if (!subject.frame.has(Aov::normal)) return std::nullopt;
  const Image& normal = subject.frame.image(Aov::normal);
  std::size_t there = 0;
  std::size_t off = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < normal.pixel_count(); ++i) {
    const auto n = normal.data().subspan(3 * i, 3);
    const double length = std::hypot(double(n[0]), double(n[1]), double(n[2]));
    if (!(length > 0.0)) continue;
    ++there;
    sum += length;
    if (std::abs(length - 1.0) > kTolerance) ++off;
  }
  if (there == 0 || static_cast<double>(off) <= kLargestShareOfOtherLength * static_cast<double>(there))
    return std::nullopt;
  return Finding{
      "normal_length",
      fmt::format("{:.0f} % of the normals are not of unit length ({:.2f} on average), as those that are "
                  "scaled to [0,1] for viewing: write them as they are, or use --layers normal=none",
                  100.0 * static_cast<double>(off) / static_cast<double>(there),
                  sum / static_cast<double>(there))};
}

}  // namespace becalm::audit
