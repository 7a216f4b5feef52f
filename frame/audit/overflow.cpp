#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "frame/audit/audit.h"

namespace becalm::audit {
namespace {

constexpr float kLargestHalf = 65504.0f;

}  // namespace

std::optional<Finding> check_overflow(const Subject& subject) {
  const std::ptrdiff_t count =
      std::ranges::count_if(subject.frame.image(Aov::beauty).data(),
                            [](float value) { return std::isinf(value) || std::abs(value) == kLargestHalf; });
  if (count == 0) return std::nullopt;
  return Finding{"overflow",
                 fmt::format("{} values of the beauty are infinite or 65504, the largest that half can "
                             "hold: write float, or scale the light down",
                             count)};
}

}  // namespace becalm::audit
