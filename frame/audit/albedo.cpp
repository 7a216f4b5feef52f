#include <fmt/format.h>

#include <algorithm>

#include "frame/audit/audit.h"

namespace becalm::audit {
namespace {

constexpr float kLargest = 1.01f;  // a pixel filter of either sign and rounding to half may pass 1
constexpr double kLargestShareAboveOne = 0.001;

}  // namespace

std::optional<Finding> check_albedo(const Subject& subject) {
  if (!subject.frame.has(Aov::albedo)) return std::nullopt;
  const auto values = subject.frame.image(Aov::albedo).data();
  const auto count = std::ranges::count_if(values, [](float value) { return value > kLargest; });
  const double share = static_cast<double>(count) / static_cast<double>(values.size());
  if (share <= kLargestShareAboveOne) return std::nullopt;
  return Finding{
      "albedo",
      fmt::format("{:.1f} % of the albedo is above 1, up to {:.3g}, so that it is no reflectance: leave "
                  "light and emission out of it, or use --layers albedo=none",
                  100.0 * share, std::ranges::max(values))};
}

}  // namespace becalm::audit
