#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "frame/audit/audit.h"
#include "frame/audit/pixels.h"

namespace becalm::audit {
namespace {

/// Below this share of rough pixels, detail is rather the picture's than noise.
constexpr double kNoisyShare = 0.05;
constexpr double kLargestCorrelation = 0.7;

/// Fine detail, limited to what nine tenths of the pixels have: a few bright pixels that stand still outweigh
/// no noise. 0 where radiance is so large that sums overflow.
std::vector<float> limited_detail(const Image& beauty) {
  std::vector<float> detail = fine_detail(beauty);
  std::ranges::replace_if(
      detail, [](float value) { return !std::isfinite(value); }, 0.0f);
  std::vector<float> sizes(detail.size());
  std::ranges::transform(detail, sizes.begin(), [](float value) { return std::abs(value); });
  const auto largest = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() * 9 / 10);
  std::ranges::nth_element(sizes, largest);
  for (float& value : detail) value = std::clamp(value, -*largest, *largest);
  return detail;
}

double correlation(const std::vector<float>& a, const std::vector<float>& b) {
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += double(a[i]) * b[i];
    aa += double(a[i]) * a[i];
    bb += double(b[i]) * b[i];
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

}  // namespace

std::optional<Finding> check_fixed_noise(const Subject& subject) {
  if (!subject.has_pair(Aov::beauty)) return std::nullopt;
  const Image& now = subject.frame.image(Aov::beauty);
  const Image& before = subject.before->image(Aov::beauty);
  if (std::ranges::equal(now.data(), before.data())) return std::nullopt;  // check_duplicate tells of it
  if (rough_share(now).value_or(0.0) < kNoisyShare) return std::nullopt;
  const double alike = correlation(limited_detail(now), limited_detail(before));
  if (alike < kLargestCorrelation) return std::nullopt;
  return Finding{
      "fixed_noise",
      fmt::format("{:.0f} % of the noise is that of the frame before, as with one seed for all frames, "
                  "and merging frames does not remove it: render with a seed that changes",
                  100.0 * alike)};
}

}  // namespace becalm::audit
