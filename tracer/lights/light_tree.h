#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tracer/lights/light_bounds.h"
#include "tracer/lights/receiver.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Chooses one of many emitters by what it may send to a point: down a binary tree of bounds, in proportion
/// to intensity / distance^2 and to the cosines of the least angles at which the cluster shines and at which
/// the receiver sees it. An emitter that cannot shine on the receiver is passed over where its bounds tell;
/// one that can is always in reach. Monotone in u for a given receiver. Emitters without intensity are not in
/// the tree.
///
/// Source: Conty Estevez and Kulla 2018 (see LightBounds) with one light a leaf and no splitting at run time,
/// as in Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th ed., section 12.6.3.
class LightTree {
 public:
  struct Choice {
    std::size_t index;
    float probability;  ///< > 0
  };

  LightTree() = default;
  explicit LightTree(std::span<const LightBounds> emitters);

  bool empty() const { return nodes_.empty(); }

  /// u in [0,1]. Nothing where no emitter of the cluster that u leads to can shine on the receiver, or the
  /// probability leaves the range of float.
  std::optional<Choice> sample(const Receiver& at, float u) const;

  /// The probability with which sample() chooses that emitter, bit for bit.
  float probability(std::size_t index, const Receiver& at) const;

  /// What all emitters together may send to the receiver, roughly, as irradiance.h has it; 0 where none can
  /// shine on it.
  double irradiance_at(const Receiver& at) const;
  /// Whether that is not 0.
  bool reaches(const Receiver& at) const;

 private:
  /// A receiver in double.
  struct Target {
    V3d position;
    V3d normal;
    bool faces;

    explicit Target(const Receiver& at) : position(at.position), normal(at.normal), faces(at.faces()) {}
  };
  struct Node {
    V3f center;
    float radius;  ///< of a sphere around the bounds
    V3f axis;
    float cos_facing, sin_facing;
    float cos_emission;
    bool two_sided;
    std::uint32_t right;  ///< the second child, the first being the next node; of a leaf: 0
    std::uint32_t emitter;
    double intensity;  ///< part of the whole

    Node(const LightBounds& bounds, double whole);
    double importance(const Target& target) const;
  };
  class Builder;

  /// Probability of the first child; nothing where neither can shine on the target.
  std::optional<double> first_share(std::size_t node, const Target& target) const;

  std::vector<Node> nodes_;  ///< depth first
  /// The turns from the root to each emitter, the first in the lowest bit, 1 to the second child.
  std::vector<std::uint64_t> trails_;
  double whole_ = 0.0;                ///< intensity of all emitters
  std::vector<std::uint32_t> parts_;  ///< few nodes that hold all emitters: what irradiance_at() adds up
};

}  // namespace becalm::tracer
