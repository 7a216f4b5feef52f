#pragma once

#include <limits>
#include <vector>

#include "tests/tracer/shading/statistics.h"
#include "tracer/media/grid_medium.h"

namespace becalm::tracer {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Mean of independent samples, and the probability of a mean as far from the truth if that were the
/// expectation.
class MeanTest {
 public:
  void add(double x) {
    const double delta = x - mean_;
    mean_ += delta / ++count_;
    squares_ += delta * (x - mean_);
  }
  double mean() const { return mean_; }
  double standard_error() const;
  double p_value(double truth) const;

 private:
  double count_ = 0.0;
  double mean_ = 0.0;
  double squares_ = 0.0;
};

/// Random numbers for tracking, seeded as a path seeds them.
inline MediumRandom medium_random(TestRandom& random) {
  return MediumRandom(random.next_2d());
}

/// Smooth lumps with empty blocks between them; the sizes are no multiples of a block.
DensityGrid lumpy_grid();

/// `grid` in the box [-1,1]^3 placed by `medium_to_world`.
GridMedium place(DensityGrid grid, const M44d& medium_to_world, float extinction);

/// A turned, stretched and moved box.
M44d oblique_place();

struct TestRay {
  V3f origin;
  V3f dir;  ///< of unit length
  float t_max;
};

/// Optical depth of the ray from 0 to each of the distances, which increase: the density, cubic between the
/// planes through voxels, is integrated exactly from one crossing to the next, in double, straight from the
/// voxels.
std::vector<double> optical_depths(const GridMedium& medium, const TestRay& ray,
                                   const std::vector<double>& distances);

}  // namespace becalm::tracer
