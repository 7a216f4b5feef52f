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
    nodes_.resize(weights.size() + 1);
    double sum = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) nodes_[i + 1].cdf = sum += usable(weights[i]) / largest;
    for (Node& node : nodes_) node.cdf /= sum;
    std::uint32_t index = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      while (nodes_[index + 1].cdf <= static_cast<double>(k) / static_cast<double>(weights.size())) ++index;
      nodes_[k].guide = index;
    }
  }

  /// Whether there is nothing to choose.
  bool empty() const { return nodes_.empty(); }

  float probability(std::size_t index) const {
    return empty() ? 0.0f : static_cast<float>(nodes_[index + 1].cdf - nodes_[index].cdf);
  }

  /// u in [0,1]; not to be called when empty().
  Choice sample(float u) const {
    const double target = std::min(u, kLargestBelowOne);
    // The first entry whose upper bound exceeds the target; the bound of the last that has a share is 1.
    const auto entries = static_cast<double>(nodes_.size() - 1);
    std::size_t index = nodes_[static_cast<std::size_t>(target * entries)].guide;
    while (nodes_[index + 1].cdf <= target) ++index;
    const double share = nodes_[index + 1].cdf - nodes_[index].cdf;
    const double inside = (target - nodes_[index].cdf) / share;
    return {index, static_cast<float>(share), std::min(static_cast<float>(inside), kLargestBelowOne)};
  }

 private:
  static constexpr float kLargestBelowOne = 0x1.fffffep-1f;
  static double usable(double weight) { return weight > 0.0 && std::isfinite(weight) ? weight : 0.0; }

  /// Both together, since where weights are even they are read from the same cache line.
  struct Node {
    double cdf = 0.0;  ///< n + 1 from 0 to 1
    /// Where to start looking for a target in [k/n, (k+1)/n): two steps on average, whatever the weights
    /// (Chen and Asau 1974). An alias table would be as fast, but scatters stratified numbers.
    std::uint32_t guide = 0;
  };
  std::vector<Node> nodes_;
};

}  // namespace becalm::tracer
