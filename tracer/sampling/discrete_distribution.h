#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace becalm::tracer {

/// Chooses one of n entries with a probability proportional to its weight; entries whose weight is zero,
/// negative or not finite are never chosen. Monotone in u, so that a stratified u gives stratified choices.
class DiscreteDistribution {
 public:
  struct Choice {
    std::size_t index;
    float probability;
    float u;  ///< where in its share of [0,1) u fell, in [0,1): a fresh number, with fewer bits
  };

  DiscreteDistribution() = default;
  explicit DiscreteDistribution(std::span<const double> weights) {
    // Weights are scaled by the largest first, so that sums of up to 1e300 each cannot overflow.
    double largest = 0.0;
    for (const double weight : weights) largest = std::max(largest, usable(weight));
    if (largest == 0.0) return;
    cdf_.reserve(weights.size() + 1);
    cdf_.push_back(0.0);
    for (const double weight : weights) cdf_.push_back(cdf_.back() + usable(weight) / largest);
    const double sum = cdf_.back();
    for (double& entry : cdf_) entry /= sum;
    guide_.reserve(weights.size());
    std::uint32_t index = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      while (cdf_[index + 1] <= static_cast<double>(k) / static_cast<double>(weights.size())) ++index;
      guide_.push_back(index);
    }
  }

  /// Whether there is nothing to choose.
  bool empty() const { return cdf_.empty(); }

  float probability(std::size_t index) const {
    return empty() ? 0.0f : static_cast<float>(cdf_[index + 1] - cdf_[index]);
  }

  /// u in [0,1]; not to be called when empty().
  Choice sample(float u) const {
    const double target = std::min(u, kLargestBelowOne);
    // The first entry whose upper bound exceeds the target; the bound of the last that has a share is 1.
    std::size_t index = guide_[static_cast<std::size_t>(target * static_cast<double>(guide_.size()))];
    while (cdf_[index + 1] <= target) ++index;
    const double share = cdf_[index + 1] - cdf_[index];
    const double inside = (target - cdf_[index]) / share;
    return {index, static_cast<float>(share), std::min(static_cast<float>(inside), kLargestBelowOne)};
  }

 private:
  static constexpr float kLargestBelowOne = 0x1.fffffep-1f;
  static double usable(double weight) { return weight > 0.0 && std::isfinite(weight) ? weight : 0.0; }

  std::vector<double> cdf_;  ///< n + 1 entries from 0 to 1
  /// Where to start looking for a target in [k/n, (k+1)/n): two steps on average, whatever the weights (Chen
  /// and Asau 1974). An alias table would be as fast, but scatters stratified numbers.
  std::vector<std::uint32_t> guide_;
};

}  // namespace becalm::tracer
