#include "scripts/benches/tracer/ray_floor.h"

#include <tbb/parallel_for.h>

#include <atomic>

namespace becalm::bench {

RayFloor::RayFloor(tracer::Scene& scene, int frame, tracer::RenderOptions options) {
  options.rays = &tiles_;
  tracer::render_frame(scene, frame, options);
  for (const auto& tile : tiles_) {
    rays_ += tile.size();
    occlusion_rays_ += std::ranges::count_if(tile, &tracer::RecordedRay::occlusion);
  }
}

Duration RayFloor::replay(const tracer::Intersector& intersector) const {
  // The result is used, so that the compiler cannot remove a query.
  std::atomic<std::size_t> hits{0};
  const Duration duration = time_of([&] {
    tbb::parallel_for(
        std::size_t{0}, tiles_.size(),
        [&](std::size_t tile) {
          std::size_t count = 0;
          for (const tracer::RecordedRay& query : tiles_[tile]) {
            count += query.occlusion ? intersector.occluded(query.ray)
                                     : intersector.closest(query.ray).has_value();
          }
          hits.fetch_add(count, std::memory_order_relaxed);
        },
        tbb::simple_partitioner());
  });
  return hits > rays_ ? Duration{} : duration;
}

}  // namespace becalm::bench
