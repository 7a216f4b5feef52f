#include "tracer/render.h"

#include <fmt/format.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <mutex>

#include "frame/error.h"
#include "tracer/film.h"
#include "tracer/path_trace.h"

namespace becalm::tracer {

namespace {

constexpr int kMostSamples = 65536;

bool wants_guides(const AovSet& aovs) {
  for (const Aov aov : {Aov::albedo, Aov::normal, Aov::depth, Aov::motion}) {
    if (aovs.test(static_cast<std::size_t>(aov))) return true;
  }
  return false;
}

bool is_finite(const PathSample& sample) {
  const Guides& g = sample.guides;
  return tracer::is_finite(sample.radiance) && tracer::is_finite(g.albedo) && tracer::is_finite(g.normal) &&
         !std::isnan(g.depth) && std::isfinite(g.motion.x) && std::isfinite(g.motion.y);
}

/// What every sample of a frame is made from.
struct FrameSetup {
  FrameSetup(Scene& scene, int frame_number, const RenderOptions& options)
      : snapshot(scene.at_frame(frame_number)),
        description(scene.description()),
        frame(frame_number),
        width(options.width > 0 ? options.width : description.film.width),
        height(options.height > 0 ? options.height : description.film.height),
        seed(options.seed),
        camera(snapshot.camera(), description.camera.fov_y_deg, width, height),
        previous_camera(snapshot.previous_camera(), description.camera.fov_y_deg, width, height),
        guides(wants_guides(options.aovs)),
        trace(select_path_function(scene.needs(), guides)) {}

  PathContext context() const {
    return {snapshot, description.integrator, camera, previous_camera,
            Textures::Reader(description.textures)};
  }

  PathSample sample_pixel(const PathContext& context, int x, int y, std::uint32_t index) const {
    Sampler sampler(seed, frame, x, y, index);
    const V2f offset = sample(description.film.filter, sampler.next_2d());
    const V2f raster(static_cast<float>(x) + 0.5f + offset.x, static_cast<float>(y) + 0.5f + offset.y);
    return trace(context, raster, sampler);
  }

  const Snapshot& snapshot;
  const SceneDescription& description;
  int frame;
  int width, height;
  std::uint32_t seed;
  Camera camera, previous_camera;
  bool guides;
  PathFunction trace;
};

void check(const RenderOptions& options) {
  if (options.spp < 1 || options.spp > kMostSamples) {
    throw Error(ExitStatus::usage, fmt::format("spp: {}: expected 1 to {}", options.spp, kMostSamples));
  }
  const bool halves = options.aovs.test(static_cast<std::size_t>(Aov::half_a)) ||
                      options.aovs.test(static_cast<std::size_t>(Aov::half_b));
  if (halves && options.spp < 2)
    throw Error(ExitStatus::usage, "half_a, half_b: expected at least 2 samples per pixel");
}

Frame make_frame(const FrameSetup& setup, const AovSet& aovs) {
  Frame frame(setup.frame, setup.width, setup.height);
  frame.add(Aov::beauty);
  for (const AovInfo& entry : kAovTable) {
    if (!entry.diagnostic && aovs.test(static_cast<std::size_t>(entry.aov))) frame.add(entry.aov);
  }
  return frame;
}

}  // namespace

std::optional<Frame> render_frame(Scene& scene, int frame_number, const RenderOptions& options,
                                  RenderReport* report) {
  const auto start = std::chrono::steady_clock::now();
  check(options);
  const FrameSetup setup(scene, frame_number, options);
  Frame frame = make_frame(setup, options.aovs);

  const auto cancelled = [&] {
    return options.cancel != nullptr && options.cancel->load(std::memory_order_relaxed);
  };
  // Aligned blocks of the sampler's sequence are stratified, so the halves are the first and the second, not
  // odd and even.
  const std::uint32_t spp = static_cast<std::uint32_t>(options.spp), half = (spp + 1) / 2;
  std::atomic<std::size_t> pixels_done{0};
  std::mutex report_mutex;
  RenderReport total;

  const auto render_tile = [&](const tbb::blocked_range2d<int>& tile) {
    const PathContext context = setup.context();
    std::size_t non_finite = 0;
    std::optional<PixelSample> first_non_finite;
    for (int y = tile.rows().begin(); y != tile.rows().end(); ++y) {
      for (int x = tile.cols().begin(); x != tile.cols().end(); ++x) {
        if (cancelled()) return;
        PixelStatistics pixel;
        for (std::uint32_t i = 0; i < spp; ++i) {
          const PathSample sample = setup.sample_pixel(context, x, y, i);
          if (!is_finite(sample)) {
            ++non_finite;
            if (!first_non_finite) first_non_finite = PixelSample{x, y, i};
            continue;
          }
          pixel.add(sample, i < half ? 0 : 1);
          if (setup.guides) pixel.add_guides(sample.guides);
        }
        pixel.write(frame, x, y);
      }
    }
    if (non_finite > 0) {
      const std::lock_guard lock(report_mutex);
      total.non_finite_samples += non_finite;
      if (!total.first_non_finite || *first_non_finite < *total.first_non_finite) {
        total.first_non_finite = first_non_finite;
      }
    }
    const std::size_t done = pixels_done += tile.rows().size() * tile.cols().size();
    if (options.progress)
      options.progress(static_cast<double>(done) / (std::size_t(setup.width) * setup.height));
  };
  const std::size_t tile_px = static_cast<std::size_t>(std::max(1, options.tile_px));
  tbb::parallel_for(tbb::blocked_range2d<int>(0, setup.height, tile_px, 0, setup.width, tile_px),
                    render_tile);
  if (cancelled()) return std::nullopt;
  setup.description.textures.check();

  if (report != nullptr) {
    total.samples = std::uint64_t{spp} * setup.width * setup.height;
    total.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    *report = total;
  }
  return frame;
}

std::vector<std::string> describe_sample(Scene& scene, int frame_number, const RenderOptions& options,
                                         const PixelSample& which) {
  check(options);
  const FrameSetup setup(scene, frame_number, options);
  if (which.x < 0 || which.x >= setup.width || which.y < 0 || which.y >= setup.height ||
      which.sample >= static_cast<std::uint32_t>(options.spp)) {
    throw Error(ExitStatus::usage,
                fmt::format("debug-pixel: {},{},{}: the frame has {}x{} pixels of {} samples", which.x,
                            which.y, which.sample, setup.width, setup.height, options.spp));
  }
  std::vector<PathVertex> path;
  PathContext context = setup.context();
  context.log = &path;
  const PathSample sample = setup.sample_pixel(context, which.x, which.y, which.sample);

  const auto text = [](const V3f& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); };
  std::vector<std::string> lines;
  lines.reserve(path.size() + 2);
  for (const PathVertex& vertex : path) {
    lines.push_back(fmt::format("{}: object '{}' at {}, throughput {}, radiance so far {}", lines.size() + 1,
                                setup.description.objects[vertex.object].name, text(vertex.position),
                                text(vertex.throughput), text(vertex.radiance)));
  }
  lines.push_back(fmt::format("radiance {}", text(sample.radiance)));
  if (setup.guides) {
    const Guides& g = sample.guides;
    lines.push_back(fmt::format("albedo {}, normal {}, depth {}, motion [{}, {}]", text(g.albedo),
                                text(g.normal), g.depth, g.motion.x, g.motion.y));
  }
  return lines;
}

}  // namespace becalm::tracer
