#pragma once

#include <Imath/ImathBox.h>

#include <optional>

#include "tracer/procedural/description.h"
#include "tracer/procedural/point.h"

namespace becalm::tracer {

/// Balls are summed in lanes: `count` is a multiple of kBallLanes, filled up with balls too far away to
/// matter.
inline constexpr int kBallLanes = 8;

/// Balls in units of a sphere that holds them all.
struct Balls {
  int count = 0;
  alignas(16) float x[kMostBalls];
  alignas(16) float y[kMostBalls];
  alignas(16) float z[kMostBalls];
  alignas(16) float radius[kMostBalls];
};

/// Melting balls at one frame: the surface where
///   f(p) = -b ln(sum over balls of exp(-(|p - c| - r) / b))
/// is 0. Its gradient is a convex combination of unit vectors, so |f(p)| is never more than p's distance from
/// the surface; along a ray its second derivative is at least -1/b.
class Blobs {
 public:
  /// Returns whether the surface changed.
  bool update(const BlobsDescription& description, double frame);

  Imath::Box3f bounds() const;
  std::optional<float> intersect(const V3f& origin, const V3f& dir, float t_min, float t_max) const;
  ProceduralPoint point(const V3f& p, float footprint) const;
  V3f point_before(const V3f& p) const { return p; }
  std::size_t bytes() const { return 0; }

  /// For tests: centre of the i-th ball in object space.
  V3f centre(int i) const;
  float radius(int i) const;

 private:
  struct Field {
    float value;
    V3f gradient;
    float nearest_centre;  ///< distance
  };

  Field field(const V3f& p) const;
  Imath::Box3f make_bounds() const;

  double unit_ = 1.0;  ///< the sphere's radius
  float blend_ = 0.0f;
  Balls balls_;
  Imath::Box3f unit_bounds_;
};

}  // namespace becalm::tracer
