#include <algorithm>
#include <cstring>

#include "frame/audit/audit.h"
#include "frame/audit/pixels.h"

namespace becalm::audit {

std::optional<Finding> check_duplicate(const Subject& subject) {
  if (!subject.has_pair(Aov::beauty)) return std::nullopt;
  const auto now = subject.frame.image(Aov::beauty).data();
  const auto before = subject.before->image(Aov::beauty).data();
  if (std::memcmp(now.data(), before.data(), now.size_bytes()) != 0) return std::nullopt;
  const auto colours = brightness(subject.frame.image(Aov::beauty));
  if (std::ranges::all_of(colours, [](float value) { return value == 0.0f; })) return std::nullopt;
  return Finding{
      "duplicate",
      "100 % of the pixels are those of the frame before, so merging them removes no noise: render "
      "the frame, or leave it out and use --missing hold"};
}

}  // namespace becalm::audit
