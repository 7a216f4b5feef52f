#include "tracer/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tracer/lights/irradiance.h"

namespace becalm::tracer {
namespace {

/// Trail of an emitter that is not in the tree; a real one has less than 64 turns.
constexpr std::uint64_t kNoTrail = ~std::uint64_t{0};
/// From here on clusters are halved, so that trails of 2^32 emitters fit into 64 bits.
constexpr int kDeepestUneven = 31;
constexpr int kBuckets = 12;
/// Clusters of no more than this are halved: the best cut is not worth the search.
constexpr std::size_t kSmallestBinned = 5;
/// A cluster counts as dark only beyond this margin in the cosine, since its bounds are rounded.
constexpr float kCosineTolerance = 1e-3f;
/// Least cosine that the importance counts: at grazing angles bounds say little.
constexpr float kLeastCosine = 0.05f;
/// Nodes that are added up for the light of all emitters together.
constexpr std::size_t kParts = 8;

/// An angle by its cosine and sine.
struct Angle {
  float cosine;
  float sine;
};

float other_leg(float cosine_or_sine) {
  return std::sqrt(std::max(0.0f, 1.0f - cosine_or_sine * cosine_or_sine));
}

/// max(0, a - b) of angles in [0, pi].
Angle less(const Angle& a, const Angle& b) {
  if (a.cosine > b.cosine) return {1.0f, 0.0f};
  return {a.cosine * b.cosine + a.sine * b.sine, a.sine * b.cosine - a.cosine * b.sine};
}

}  // namespace

LightTree::Node::Node(const LightBounds& bounds, double whole)
    : center(bounds.box.center()),
      axis(bounds.facing.axis),
      cos_facing(static_cast<float>(std::cos(bounds.facing.angle_rad))),
      sin_facing(static_cast<float>(std::sin(bounds.facing.angle_rad))),
      cos_emission(static_cast<float>(std::cos(bounds.emission_rad))),
      two_sided(bounds.two_sided),
      right(0),
      emitter(0),
      intensity(bounds.intensity / whole) {
  // Around the rounded centre, and rounded up: the sphere must hold the box.
  const V3d c(center);
  const double exact = std::max((bounds.box.max - c).length(), (bounds.box.min - c).length());
  constexpr float largest = std::numeric_limits<float>::max();
  radius = exact < largest ? std::nextafter(static_cast<float>(exact), largest) : largest;
}

double LightTree::Node::importance(const Target& target) const {
  const V3d to_target = target.position - V3d(center);
  const double squared = to_target.length2();
  const double radius_squared = static_cast<double>(radius) * radius;
  // As far as a sphere around the cluster at least: inside it the distance to the centre says nothing.
  const double falloff = intensity / std::max({squared, radius_squared, kLeastSquaredDistance});
  if (squared <= radius_squared) return falloff;
  const double inverse = 1.0 / std::sqrt(squared);
  const auto sine_subtended = static_cast<float>(radius * inverse);
  const Angle subtended{other_leg(sine_subtended), sine_subtended};
  float cosines = 1.0f;
  if (cos_facing > -1.0f) {
    const auto along_axis = static_cast<float>(to_target.dot(V3d(axis)) * inverse);
    const float cosine = two_sided ? std::abs(along_axis) : along_axis;
    const Angle least = less(less({cosine, other_leg(cosine)}, {cos_facing, sin_facing}), subtended);
    if (least.cosine < cos_emission - kCosineTolerance) return 0.0;
    cosines = std::max(least.cosine, kLeastCosine);
  }
  if (target.faces) {
    const auto cosine = static_cast<float>(-to_target.dot(target.normal) * inverse);
    const Angle least = less({cosine, other_leg(cosine)}, subtended);
    if (least.cosine < -kCosineTolerance) return 0.0;
    cosines *= std::max(least.cosine, kLeastCosine);
  }
  return falloff * cosines;
}

/// Binned top-down construction.
class LightTree::Builder {
 public:
  Builder(LightTree& tree, std::span<const LightBounds> emitters) : tree_(tree), emitters_(emitters) {
    for (std::size_t i = 0; i < emitters.size(); ++i) {
      if (emitters[i].intensity > 0.0) order_.push_back(static_cast<std::uint32_t>(i));
    }
    tree_.trails_.assign(emitters.size(), kNoTrail);
    if (order_.empty()) return;
    tree_.nodes_.reserve(2 * order_.size() - 1);
    for (const std::uint32_t i : order_) tree_.whole_ += emitters[i].intensity;
    build(0, order_.size(), 0, 0);
  }

 private:
  V3d center(std::uint32_t emitter) const { return emitters_[emitter].box.center(); }

  void build(std::size_t begin, std::size_t end, int depth, std::uint64_t trail) {
    LightBounds bounds;
    for (std::size_t i = begin; i < end; ++i) bounds = unite(bounds, emitters_[order_[i]]);
    const std::size_t node = tree_.nodes_.size();
    tree_.nodes_.emplace_back(bounds, tree_.whole_);
    if (end - begin == 1) {
      tree_.nodes_[node].emitter = order_[begin];
      tree_.trails_[order_[begin]] = trail;
      return;
    }
    const std::size_t middle = split(begin, end, depth);
    build(begin, middle, depth + 1, trail);
    tree_.nodes_[node].right = static_cast<std::uint32_t>(tree_.nodes_.size());
    build(middle, end, depth + 1, trail | std::uint64_t{1} << depth);
  }

  /// Orders the range and says where its second part begins.
  std::size_t split(std::size_t begin, std::size_t end, int depth) {
    Imath::Box3d centers;
    for (std::size_t i = begin; i < end; ++i) centers.extendBy(center(order_[i]));
    const int widest = static_cast<int>(centers.majorAxis());
    const auto first = order_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = order_.begin() + static_cast<std::ptrdiff_t>(end);
    if (depth < kDeepestUneven && end - begin >= kSmallestBinned && centers.size()[widest] > 0.0) {
      const auto [axis, bucket] = cheapest(begin, end, centers);
      const auto middle = std::partition(
          first, last, [&, a = axis, b = bucket](std::uint32_t i) { return bucket_of(i, a, centers) <= b; });
      if (middle != first && middle != last) return static_cast<std::size_t>(middle - order_.begin());
    }
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last,
                     [&](std::uint32_t a, std::uint32_t b) { return center(a)[widest] < center(b)[widest]; });
    return static_cast<std::size_t>(middle - order_.begin());
  }

  int bucket_of(std::uint32_t emitter, int axis, const Imath::Box3d& centers) const {
    const double share = (center(emitter)[axis] - centers.min[axis]) / centers.size()[axis];
    return std::min(static_cast<int>(share * kBuckets), kBuckets - 1);
  }

  /// The axis, and the last bucket of the first part, of the least cost. Long boxes are rather cut across
  /// (the paper's k_r).
  std::pair<int, int> cheapest(std::size_t begin, std::size_t end, const Imath::Box3d& centers) const {
    const V3d size = centers.size();
    const double longest = std::max({size.x, size.y, size.z});
    std::pair<int, int> best{0, 0};
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(size[axis] > 0.0)) continue;
      std::array<LightBounds, kBuckets> buckets, above;
      for (std::size_t i = begin; i < end; ++i) {
        LightBounds& bucket = buckets[bucket_of(order_[i], axis, centers)];
        bucket = unite(bucket, emitters_[order_[i]]);
      }
      above.back() = buckets.back();
      for (int b = kBuckets - 2; b >= 0; --b) above[b] = unite(buckets[b], above[b + 1]);
      LightBounds below;
      for (int b = 0; b + 1 < kBuckets; ++b) {
        below = unite(below, buckets[b]);
        if (below.intensity == 0.0 || above[b + 1].intensity == 0.0) continue;
        const double cost = longest / size[axis] * (cluster_cost(below) + cluster_cost(above[b + 1]));
        if (cost < least) {
          least = cost;
          best = {axis, b};
        }
      }
    }
    return best;
  }

  LightTree& tree_;
  std::span<const LightBounds> emitters_;
  std::vector<std::uint32_t> order_;
};

LightTree::LightTree(std::span<const LightBounds> emitters) {
  Builder(*this, emitters);
  if (empty()) return;
  parts_ = {0};
  // The node whose size says least about where its light comes from is taken apart first.
  const auto coarseness = [&](std::uint32_t node) {
    return nodes_[node].right != 0 ? nodes_[node].intensity * nodes_[node].radius : -1.0;
  };
  while (parts_.size() < kParts) {
    const auto coarsest = std::ranges::max_element(parts_, {}, coarseness);
    const std::uint32_t node = *coarsest;
    if (nodes_[node].right == 0) break;
    *coarsest = node + 1;
    parts_.push_back(nodes_[node].right);
  }
}

std::optional<double> LightTree::first_share(std::size_t node, const Target& target) const {
  const double first = nodes_[node + 1].importance(target);
  const double second = nodes_[nodes_[node].right].importance(target);
  const double sum = first + second;
  if (!(sum > 0.0)) return std::nullopt;
  return first / sum;
}

std::optional<LightTree::Choice> LightTree::sample(const Receiver& at, float u) const {
  constexpr double largest_below_one = 1.0 - 0x1p-53;
  const Target receiver(at);
  double target = std::min(static_cast<double>(u), largest_below_one);
  double probability = 1.0;
  std::size_t node = 0;
  while (nodes_[node].right != 0) {
    const std::optional<double> share = first_share(node, receiver);
    if (!share) return std::nullopt;
    if (target < *share) {
      target /= *share;
      probability *= *share;
      ++node;
    } else {
      target = (target - *share) / (1.0 - *share);
      probability *= 1.0 - *share;
      node = nodes_[node].right;
    }
    target = std::min(target, largest_below_one);
  }
  const auto rounded = static_cast<float>(probability);
  if (rounded == 0.0f) return std::nullopt;
  return Choice{nodes_[node].emitter, rounded};
}

double LightTree::irradiance_at(const Receiver& at) const {
  const Target target(at);
  double sum = 0.0;
  for (const std::uint32_t node : parts_) sum += nodes_[node].importance(target);
  return whole_ * sum;
}

bool LightTree::reaches(const Receiver& at) const {
  const Target target(at);
  return std::ranges::any_of(parts_,
                             [&](std::uint32_t node) { return nodes_[node].importance(target) > 0.0; });
}

float LightTree::probability(std::size_t index, const Receiver& at) const {
  std::uint64_t trail = trails_[index];
  if (trail == kNoTrail) return 0.0f;
  const Target target(at);
  double probability = 1.0;
  for (std::size_t node = 0; nodes_[node].right != 0; trail >>= 1) {
    const std::optional<double> share = first_share(node, target);
    if (!share) return 0.0f;
    const bool second = (trail & 1) != 0;
    probability *= second ? 1.0 - *share : *share;
    node = second ? nodes_[node].right : node + 1;
  }
  return static_cast<float>(probability);
}

}  // namespace becalm::tracer
