#pragma once

#include "frame/frame.h"
#include "tracer/path_trace.h"

namespace becalm::tracer {

/// Everything that one pixel's samples add up to, in double. All samples weigh the same.
class PixelStatistics {
 public:
  /// `half` tells to which of the two halves of the samples this one belongs.
  void add(const PathSample& sample, int half) {
    const V3d radiance(sample.radiance);
    ++count_;
    const V3d delta = radiance - mean_;
    mean_ += delta / static_cast<double>(count_);
    squares_ += delta * (radiance - mean_);
    ++half_count_[half];
    half_sum_[half] += radiance;
    covered_ += sample.covered ? 1.0 : 0.0;
  }
  void add_guides(const Guides& guides) {
    albedo_ += V3d(guides.albedo);
    normal_ += V3d(guides.normal);
    motion_ += V2d(guides.motion);
    if (std::isfinite(guides.depth)) {
      depth_ += guides.depth;
      ++depth_count_;
    }
  }

  /// Writes what the frame has images for. A pixel without samples becomes black, uncovered and of no motion.
  void write(Frame& frame, int x, int y) const;

 private:
  V3d variance_of_mean() const;

  std::uint32_t count_ = 0;
  std::uint32_t half_count_[2] = {0, 0};
  std::uint32_t depth_count_ = 0;
  V3d mean_{0.0};
  V3d squares_{0.0};  ///< sum of squared differences from the mean (Welford 1962)
  V3d half_sum_[2] = {V3d(0.0), V3d(0.0)};
  V3d albedo_{0.0}, normal_{0.0};
  V2d motion_{0.0};
  double depth_ = 0.0;
  double covered_ = 0.0;
};

}  // namespace becalm::tracer
