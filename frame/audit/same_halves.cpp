#include <algorithm>

#include "frame/audit/audit.h"

namespace becalm::audit {

std::optional<Finding> check_same_halves(const Subject& subject) {
  if (!subject.frame.has(Aov::half_a) || !subject.frame.has(Aov::half_b)) return std::nullopt;
  const auto a = subject.frame.image(Aov::half_a).data();
  const auto b = subject.frame.image(Aov::half_b).data();
  const bool is_black = std::ranges::all_of(a, [](float value) { return value == 0.0f; });
  if (is_black || !std::ranges::equal(a, b)) return std::nullopt;
  return Finding{
      "same_halves",
      "100 % of the pixels are alike in both halves of the samples, so they show no noise and none is "
      "removed: render the halves with two seeds"};
}

}  // namespace becalm::audit
