#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "frame/audit/audit.h"

namespace becalm::audit {
namespace {

constexpr int kBlock = 8;
constexpr double kLargestFactor = 3.0;

/// Of each block, the sum of `expected` squares and of `seen` ones; blocks without any are left out.
std::vector<double> block_ratios(const Image& variance, auto expected, auto seen) {
  std::vector<double> ratios;
  for (int y = 0; y + kBlock <= variance.height(); y += kBlock) {
    for (int x = 0; x + kBlock <= variance.width(); x += kBlock) {
      double told = 0.0;
      double found = 0.0;
      for (int v = y; v < y + kBlock; ++v) {
        for (int u = x; u < x + kBlock; ++u) {
          for (int c = 0; c < 3; ++c) {
            told += expected(u, v, c);
            found += seen(u, v, c);
          }
        }
      }
      if (told > 0.0 && std::isfinite(told) && std::isfinite(found)) ratios.push_back(found / told);
    }
  }
  return ratios;
}

/// The quantile: this share of the blocks is below it.
double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

Finding finding(double ratio, const char* source) {
  return {"variance",
          fmt::format("the noise that {} show has {:.2g} times the variance that the layer tells: scale "
                      "the layer to the variance of a pixel's mean, or use --layers variance=none",
                      source, ratio)};
}

double square(double value) {
  return value * value;
}

}  // namespace

std::optional<Finding> check_variance(const Subject& subject) {
  const Frame& frame = subject.frame;
  if (!frame.has(Aov::variance)) return std::nullopt;
  const Image& variance = frame.image(Aov::variance);
  const auto is_zero = [](float value) { return value == 0.0f; };
  if (std::ranges::all_of(variance.data(), is_zero) &&
      !std::ranges::all_of(frame.image(Aov::beauty).data(), is_zero)) {
    return Finding{"variance",
                   "the layer is 0 everywhere, so nothing counts as noise: --layers variance=none has it "
                   "estimated"};
  }
  if (frame.has(Aov::half_a) && frame.has(Aov::half_b)) {
    const std::vector<double> ratios = block_ratios(
        variance, [&](int x, int y, int c) { return variance.at(x, y, c); },
        [&](int x, int y, int c) {
          return square(0.5 * (frame.image(Aov::half_a).at(x, y, c) - frame.image(Aov::half_b).at(x, y, c)));
        });
    if (ratios.empty()) return std::nullopt;
    const double middle = quantile(ratios, 0.5);
    if (middle < kLargestFactor && middle > 1.0 / kLargestFactor) return std::nullopt;
    return finding(middle, "the halves");
  }
  if (!subject.has_pair(Aov::variance) || !subject.has_pair(Aov::beauty)) return std::nullopt;
  const std::vector<double> ratios = block_ratios(
      variance,
      [&](int x, int y, int c) {
        return variance.at(x, y, c) + subject.before->image(Aov::variance).at(x, y, c);
      },
      [&](int x, int y, int c) {
        return square(frame.image(Aov::beauty).at(x, y, c) - subject.before->image(Aov::beauty).at(x, y, c));
      });
  if (ratios.empty()) return std::nullopt;
  // What moves differs by more than noise, so too little variance shows in still blocks alone.
  const double still = quantile(ratios, 0.1);
  const double middle = quantile(ratios, 0.5);
  if (still > kLargestFactor) return finding(still, "still parts of two frames");
  if (middle < 1.0 / kLargestFactor) return finding(middle, "two frames");
  return std::nullopt;
}

}  // namespace becalm::audit
