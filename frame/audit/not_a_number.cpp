#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "frame/audit/audit.h"

namespace becalm::audit {

std::optional<Finding> check_not_a_number(const Subject& subject) {
  for (const Aov aov : {Aov::beauty, Aov::albedo, Aov::normal, Aov::depth}) {
    if (!subject.frame.has(aov)) continue;
    auto count = static_cast<std::size_t>(std::ranges::count_if(
        subject.frame.image(aov).data(), [](float value) { return std::isnan(value); }));
    if (aov == Aov::beauty && subject.frame.cut())
      count -= std::min(count, 3 * subject.frame.cut()->unknown_pixels);
    if (count == 0) continue;
    return Finding{"not_a_number",
                   fmt::format("{} values of the {} are NaN{}: find the shader that makes them, or "
                               "render them again",
                               count, aov == Aov::beauty ? "beauty" : info(aov).name,
                               aov == Aov::beauty ? ", and such pixels stay as they are" : "")};
  }
  return std::nullopt;
}

}  // namespace becalm::audit
