#include <fmt/format.h>

#include "frame/audit/audit.h"

namespace becalm::audit {
namespace {

constexpr double kLargestShareOfColour = 0.01;

}  // namespace

std::optional<Finding> check_premultiplied(const Subject& subject) {
  const Image& beauty = subject.frame.image(Aov::beauty);
  std::size_t transparent = 0;
  std::size_t coloured = 0;
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    const auto pixel = beauty.data().subspan(4 * i, 4);
    if (pixel[3] != 0.0f) continue;
    ++transparent;
    if (pixel[0] != 0.0f || pixel[1] != 0.0f || pixel[2] != 0.0f) ++coloured;
  }
  if (transparent == 0) return std::nullopt;
  const double share = static_cast<double>(coloured) / static_cast<double>(transparent);
  if (share <= kLargestShareOfColour) return std::nullopt;
  return Finding{
      "premultiplied",
      fmt::format(
          "{:.0f} % of the pixels with alpha 0 have colour, so that it is not premultiplied or alpha is "
          "not that of the colour: premultiply it, or expect fringes where the alpha is used",
          100.0 * share)};
}

}  // namespace becalm::audit
