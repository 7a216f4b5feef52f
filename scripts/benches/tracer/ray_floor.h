#pragma once

#include <cstdint>
#include <vector>

#include "scripts/benches/stopwatch.h"
#include "tracer/render.h"

namespace becalm::bench {

/// The ray queries of a frame. Their time alone is a lower bound of the frame's render time.
class RayFloor {
 public:
  RayFloor(tracer::Scene& scene, int frame, tracer::RenderOptions options);

  std::size_t rays() const { return rays_; }
  double occlusion_share() const { return static_cast<double>(occlusion_rays_) / static_cast<double>(rays_); }

  /// Traces them again, tile by tile as the render does, with the same number of threads.
  Duration replay(const tracer::Intersector& intersector) const;

 private:
  std::vector<std::vector<tracer::RecordedRay>> tiles_;
  std::size_t rays_ = 0;
  std::size_t occlusion_rays_ = 0;
};

}  // namespace becalm::bench
