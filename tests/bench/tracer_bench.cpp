#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "tracer/render.h"
#include "tracer/scene/load.h"

using namespace becalm;
using namespace becalm::tracer;

static double seconds(auto&& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int main(int argc, char** argv) {
  for (int a = 1; a < argc; ++a) {
    Scene scene = load_scene(argv[a]);
    RenderOptions options;
    options.spp = 4;
    const int frame = scene.description().frames.first;
    scene.at_frame(frame);
    const auto rays = record_rays(scene, frame, options);
    std::size_t count = 0;
    for (const auto& tile : rays) count += tile.size();
    std::vector<double> render, replay;
    for (int i = 0; i < 5; ++i) {
      render.push_back(seconds([&] { render_frame(scene, frame, options); }));
      std::atomic<std::size_t> hits = 0;
      replay.push_back(seconds([&] {
        const Intersector& x = scene.at_frame(frame).intersector();
        tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t t) {
          std::size_t n = 0;
          for (const RecordedRay& r : rays[t]) n += r.occlusion ? x.occluded(r.ray) : x.closest(r.ray).has_value();
          hits += n;
        }, tbb::simple_partitioner());
      }));
    }
    std::ranges::sort(render);
    std::ranges::sort(replay);
    fmt::print("{}: {} rays, render {:.3f} s, replay {:.3f} s, ratio {:.2f}, {:.1f} Mrays/s\n", argv[a], count, render[2], replay[2],
               render[2] / replay[2], count / render[2] * 1e-6);
  }
}
