#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
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
  }

  /// Whether there is nothing to choose.
  bool empty() const { return cdf_.empty(); }

  float probability(std::size_t index) const {
    return empty() ? 0.0f : static_cast<float>(cdf_[index + 1] - cdf_[index]);
  }

  /// u in [0,1]; not to be called when empty().
  Choice sample(float u) const {
    // The first entry whose upper bound exceeds u has a positive share; u = 1 falls to the last such entry.
    auto upper = std::upper_bound(cdf_.begin() + 1, cdf_.end(), static_cast<double>(u));
    if (upper == cdf_.end()) upper = std::lower_bound(cdf_.begin() + 1, cdf_.end(), 1.0);
    const std::size_t index = static_cast<std::size_t>(upper - cdf_.begin()) - 1;
    const double share = cdf_[index + 1] - cdf_[index];
    const double inside = (static_cast<double>(u) - cdf_[index]) / share;
    return {index, static_cast<float>(share), std::min(static_cast<float>(inside), 0x1.fffffep-1f)};
  }

 private:
  static double usable(double weight) { return weight > 0.0 && std::isfinite(weight) ? weight : 0.0; }

  std::vector<double> cdf_;  ///< n + 1 entries from 0 to 1
};

}  // namespace becalm::tracer
