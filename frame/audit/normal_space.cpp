#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "frame/audit/audit.h"

namespace becalm::audit {
namespace {

constexpr double kShareFacing = 0.995;
/// A floor alone faces one way in any space; view space has slanted normals besides.
constexpr double kShareSlanted = 0.2;

}  // namespace

std::optional<Finding> check_normal_space(const Subject& subject) {
  if (!subject.frame.has(Aov::normal)) return std::nullopt;
  const Image& normal = subject.frame.image(Aov::normal);
  std::size_t there = 0;
  std::size_t towards = 0;
  std::size_t slanted = 0;
  for (std::size_t i = 0; i < normal.pixel_count(); ++i) {
    const auto n = normal.data().subspan(3 * i, 3);
    const double length = std::hypot(double(n[0]), double(n[1]), double(n[2]));
    if (!(length > 0.0)) continue;
    ++there;
    if (n[2] > 0.0f) ++towards;
    if (std::abs(n[2]) > 0.05 * length && std::abs(n[2]) < 0.9 * length) ++slanted;
  }
  if (there == 0) return std::nullopt;
  const double facing = static_cast<double>(std::max(towards, there - towards)) / static_cast<double>(there);
  if (facing < kShareFacing || static_cast<double>(slanted) < kShareSlanted * static_cast<double>(there)) {
    return std::nullopt;
  }
  return Finding{
      "normal_space",
      fmt::format(
          "{:.1f} % of the normals face one way along Z, as in view space, where they change when "
          "the camera turns: write normals in world space, or --layers normal=NAME takes a layer that is",
          100.0 * facing)};
}

}  // namespace becalm::audit
