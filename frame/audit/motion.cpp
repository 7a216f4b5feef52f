#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "frame/audit/audit.h"
#include "frame/audit/pixels.h"

namespace becalm::audit {
namespace {

struct Change {
  std::string_view option;  ///< of --motion; empty for the vectors as they are
  float x;                  ///< factors, after `swap`
  float y;
  bool swap = false;
};

constexpr std::array kChanges{Change{"", 1, 1},
                              Change{"flip-x", -1, 1},
                              Change{"flip-y", 1, -1},
                              Change{"flip-x,flip-y", -1, -1},
                              Change{"scale=0.5", 0.5, 0.5},
                              Change{"scale=2", 2, 2},
                              Change{"swap", 1, 1, true},
                              Change{"none", 0, 0}};

constexpr int kPatch = 2;            ///< half the side of what is compared, so that noise averages out
constexpr float kShortest = 1.0f;    ///< px: shorter vectors tell nothing
constexpr std::size_t kFewest = 64;  ///< vectors
constexpr double kMuchBetter = 0.6;  ///< share of the error that is left

/// Mean of a patch.
float mean_around(const std::vector<float>& values, int width, int x, int y) {
  float sum = 0.0f;
  for (int v = -kPatch; v <= kPatch; ++v) {
    for (int u = -kPatch; u <= kPatch; ++u) sum += values[static_cast<std::size_t>(y + v) * width + x + u];
  }
  return sum / ((2 * kPatch + 1) * (2 * kPatch + 1));
}

}  // namespace

std::optional<Finding> check_motion(const Subject& subject) {
  if (!subject.has_pair(Aov::beauty) || !subject.frame.has(Aov::motion)) return std::nullopt;
  const Image& motion = subject.frame.image(Aov::motion);
  const int width = motion.width();
  const int height = motion.height();
  const Aov compared = subject.has_pair(Aov::albedo) ? Aov::albedo : Aov::beauty;
  const std::vector<float> now = brightness(subject.frame.image(compared));
  const std::vector<float> before = brightness(subject.before->image(compared));
  std::array<double, kChanges.size()> errors{};
  std::size_t count = 0;
  const auto inside = [&](int x, int y) {
    return x >= kPatch && y >= kPatch && x + kPatch < width && y + kPatch < height;
  };
  for (int y = kPatch; y + kPatch < height; y += 2) {
    for (int x = kPatch; x + kPatch < width; x += 2) {
      const float mx = motion.at(x, y, 0);
      const float my = motion.at(x, y, 1);
      if (!(std::hypot(mx, my) >= kShortest) || !(std::hypot(mx, my) < static_cast<float>(width + height)))
        continue;
      std::array<double, kChanges.size()> error{};
      bool all_inside = true;
      for (std::size_t i = 0; i < kChanges.size() && all_inside; ++i) {
        const Change& change = kChanges[i];
        const int u = x + static_cast<int>(std::lround(change.x * (change.swap ? my : mx)));
        const int v = y + static_cast<int>(std::lround(change.y * (change.swap ? mx : my)));
        all_inside = inside(u, v);
        if (all_inside) {
          error[i] = std::abs(mean_around(now, width, x, y) - mean_around(before, width, u, v));
        }
      }
      if (!all_inside) continue;  // all changes are judged by the same vectors
      ++count;
      for (std::size_t i = 0; i < errors.size(); ++i) errors[i] += error[i];
    }
  }
  if (count < kFewest) return std::nullopt;
  const auto best = static_cast<std::size_t>(std::ranges::min_element(errors) - errors.begin());
  if (best == 0 || errors[best] > kMuchBetter * errors[0]) return std::nullopt;
  const double left = 100.0 * errors[best] / errors[0];
  if (kChanges[best].option == "none") {
    return Finding{
        "motion",
        fmt::format("without the motion vectors, the frame before differs by {:.0f} % of what it does "
                    "along them, so they are not this picture's: use --layers motion=none",
                    left)};
  }
  return Finding{"motion",
                 fmt::format("along motion vectors with {0}, the frame before differs by {1:.0f} % of what "
                             "it does along them as they are: use --motion {0}",
                             kChanges[best].option, left)};
}

}  // namespace becalm::audit
