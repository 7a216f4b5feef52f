#include "tracer/render.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <mutex>

#include "frame/error.h"
#include "tracer/film.h"
#include "tracer/path_trace.h"
#include "tracer/sample_counts.h"

namespace becalm::tracer {

namespace {

/// Frames of more samples do not tell their positions: nothing is antialiased by them.
constexpr std::uint32_t kMostSharedPositions = 64;

/// Added to the right eye's seed, so that its noise is its own. Users count seeds up from 0.
constexpr std::uint32_t kRightEyeSeed = 0x57e2e000u;

bool wants_guides(const AovSet& aovs) {
  for (const Aov aov :
       {Aov::albedo, Aov::normal, Aov::depth, Aov::motion, Aov::object_id, Aov::material_id}) {
    if (contains(aovs, aov)) return true;
  }
  return false;
}

bool wants_split(const RenderOptions& options) {
  return contains(options.aovs, Aov::direct) || contains(options.aovs, Aov::indirect) || options.light_groups;
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
        spp(static_cast<std::uint32_t>(options.spp)),
        sample_counts(options.sample_counts),
        aov_spp(static_cast<std::uint32_t>(options.aov_spp)),
        seed(options.seed + (options.eye == Eye::right ? kRightEyeSeed : 0)),
        eye(options.eye),
        checkerboard(options.checkerboard
                         ? std::optional((frame_number & 1) == 0 ? Parity::even : Parity::odd)
                         : std::nullopt),
        jitter_frame(jitter_frame_of(frame_number - std::int64_t{description.frames.first})),
        cameras(description.camera, frame_number, width, height, eye),
        eye_interiors(scene.needs().media ? interiors_at(snapshot, cameras.current().eye()) : Interiors()),
        guides(wants_guides(options.aovs)),
        mixes(scene.needs().mix),
        trace((options.variant != nullptr ? *options.variant : select_path_variant(scene.needs(), guides))
                  .function) {}

  PathContext context() const {
    return {snapshot,
            description.integrator,
            cameras,
            eye_interiors,
            Textures::Reader(description.textures),
            footprint_scale(static_cast<int>(samples_a_cycle())),
            mixes};
  }

  /// Jittered frames are averaged over time, so that textures are filtered as for the samples of a whole
  /// cycle (Yang et al. 2020, section 3.1: the mip bias).
  std::uint32_t samples_a_cycle() const { return std::max(spp, description.film.jitter.cycle); }

  /// Set if all pixels have the same few positions.
  std::optional<FrameJitter> shared_positions() const {
    const Film& film = description.film;
    const std::uint32_t points = film.jitter.points(spp);
    if (film.jitter.cycle == 0 || points > kMostSharedPositions || sample_counts != nullptr)
      return std::nullopt;
    FrameJitter jitter{.positions_px = {}, .filter = film.filter.type, .radius_px = film.filter.radius_px};
    for (std::uint32_t i = 0; i < points; ++i) {
      jitter.positions_px.push_back(sample(film.filter, film.jitter.point(jitter_frame, spp, i)));
    }
    return jitter;
  }

  std::optional<StereoView> stereo() const {
    if (eye == Eye::centre) return std::nullopt;
    const CameraSettings& camera = description.camera;
    const std::optional<StereoCamera> pair =
        stereo_camera_at(camera, camera.shutter.at(frame, 0.0), width, height);
    return pair ? std::optional(StereoView{*pair, eye}) : std::nullopt;
  }

  std::uint32_t samples_of(int x, int y) const {
    if (!is_rendered(x, y)) return 0;
    return sample_counts == nullptr ? spp : static_cast<std::uint32_t>(sample_counts->at(x, y, 0));
  }
  bool is_rendered(int x, int y) const { return !checkerboard || has_sample(*checkerboard, x, y); }

  PathSample sample_pixel(const PathContext& context, int x, int y, std::uint32_t index) const {
    Sampler sampler(seed, frame, x, y, index);
    const V2f offset = sample(description.film.filter, filter_point(sampler, index));
    const V2f raster(static_cast<float>(x) + 0.5f + offset.x, static_cast<float>(y) + 0.5f + offset.y);
    return trace(context, raster, sampler);
  }

  /// Position in the pixel filter, in [0,1)^2: the sampler's, or with jitter the one that all pixels share
  /// for this sample number.
  V2f filter_point(Sampler& sampler, std::uint32_t index) const {
    const V2f u = sampler.next_2d();
    const Jitter& jitter = description.film.jitter;
    return jitter.cycle == 0 ? u : jitter.point(jitter_frame, spp, index);
  }

  /// In a checkerboard a pixel has samples in every other frame, which together shall have all positions.
  std::int64_t jitter_frame_of(std::int64_t number) const { return checkerboard ? number >> 1 : number; }

  const Snapshot& snapshot;
  const SceneDescription& description;
  int frame;
  int width, height;
  std::uint32_t spp;
  const Image* sample_counts;
  std::uint32_t aov_spp;
  std::uint32_t seed;
  Eye eye;
  std::optional<Parity> checkerboard;
  std::int64_t jitter_frame;  ///< that the jitter is of
  CameraAnimation cameras;
  Interiors eye_interiors;
  bool guides;
  bool mixes;
  PathFunction trace;
};

/// A block of pixels that one thread renders at a time.
struct Tile {
  int x0, y0, x1, y1;
  std::size_t pixels() const { return static_cast<std::size_t>(x1 - x0) * static_cast<std::size_t>(y1 - y0); }
};

std::vector<Tile> make_tiles(int width, int height, int tile_px) {
  const int side = std::max(1, tile_px);
  std::vector<Tile> tiles;
  for (int y = 0; y < height; y += side) {
    for (int x = 0; x < width; x += side)
      tiles.push_back({x, y, std::min(x + side, width), std::min(y + side, height)});
  }
  return tiles;
}

void check(const RenderOptions& options) {
  if (options.spp < 1 || options.spp > kMostSamples) {
    throw Error(ExitStatus::usage, fmt::format("spp: {}: expected 1 to {}", options.spp, kMostSamples));
  }
  if (options.aov_spp < 0 || options.aov_spp > kMostSamples) {
    throw Error(ExitStatus::usage,
                fmt::format("aov_spp: {}: expected 0 to {}", options.aov_spp, kMostSamples));
  }
  float least = static_cast<float>(options.spp);
  if (options.sample_counts != nullptr) {
    least = kMostSamples;
    for (const float count : options.sample_counts->data()) {
      if (!(count >= 1.0f && count <= kMostSamples)) {  // or NaN
        throw Error(ExitStatus::usage,
                    fmt::format("sample_counts: {}: expected 1 to {}", count, kMostSamples));
      }
      least = std::min(least, count);
    }
  }
  const bool halves = contains(options.aovs, Aov::half_a) || contains(options.aovs, Aov::half_b);
  if (halves && least < 2)
    throw Error(ExitStatus::usage, "half_a, half_b: expected at least 2 samples per pixel");
}

void check_size(const Image& sample_counts, int width, int height) {
  if (sample_counts.width() == width && sample_counts.height() == height) return;
  throw Error(ExitStatus::usage, fmt::format("sample_counts: {}x{} pixels: the frame has {}x{}",
                                             sample_counts.width(), sample_counts.height(), width, height));
}

Frame make_frame(const FrameSetup& setup, const RenderOptions& options) {
  Frame frame(setup.frame, setup.width, setup.height);
  frame.add(Aov::beauty);
  frame.set_jitter(setup.shared_positions());
  frame.set_stereo(setup.stereo());
  frame.set_checkerboard(setup.checkerboard);
  for (const AovInfo& entry : kAovTable) {
    if (!entry.diagnostic && contains(options.aovs, entry.aov)) frame.add(entry.aov);
  }
  if (options.light_groups) {
    for (const std::string& name : setup.description.light_groups)
      frame.light_groups().push_back({name, Image(setup.width, setup.height, 3)});
  }
  return frame;
}

/// Adds the samples of a part of the frame.
void add(RenderReport& total, const RenderReport& part) {
  total.samples += part.samples;
  total.non_finite_samples += part.non_finite_samples;
  if (part.first_non_finite &&
      (!total.first_non_finite || *part.first_non_finite < *total.first_non_finite)) {
    total.first_non_finite = part.first_non_finite;
  }
}

/// Renders pixels one after the other, on one thread, and counts their samples.
class PixelRenderer {
 public:
  /// The ray queries are appended to `rays` if it is not null.
  PixelRenderer(const FrameSetup& setup, bool splits, std::vector<RecordedRay>* rays)
      : setup_(setup),
        splits_(splits),
        split_(splits ? setup.description.light_groups.size() : 0),
        split_statistics_(split_.groups.size()),
        context_(setup.context()),
        guides_context_(setup.context()) {
    if (splits_) context_.split = &split_;
    guides_context_.guides_only = true;
    context_.rays = guides_context_.rays = rays;
  }
  PixelRenderer(const PixelRenderer&) = delete;
  PixelRenderer& operator=(const PixelRenderer&) = delete;

  void render(int x, int y, Frame& frame) {
    const std::uint32_t spp = setup_.samples_of(x, y);
    report_.samples += spp;
    statistics_.clear(spp);
    if (splits_) split_statistics_.clear();
    for (std::uint32_t i = 0; i < spp; ++i) add_sample(x, y, i);
    const std::uint32_t guide_samples = setup_.guides && spp > 0 ? setup_.aov_spp : 0;
    for (std::uint32_t i = spp; i < guide_samples; ++i) {
      const PathSample sample = setup_.sample_pixel(guides_context_, x, y, i);
      if (is_usable(sample, {x, y, i})) statistics_.add_guides(sample.guides);
    }
    statistics_.write(frame, x, y);
    if (splits_) split_statistics_.write(frame, x, y);
  }

  const RenderReport& report() const { return report_; }

 private:
  void add_sample(int x, int y, std::uint32_t index) {
    if (splits_) split_.clear();
    const PathSample sample = setup_.sample_pixel(context_, x, y, index);
    if (!is_usable(sample, {x, y, index})) return;
    statistics_.add(sample, index);
    if (setup_.guides) statistics_.add_guides(sample.guides);
    if (splits_) split_statistics_.add(split_);
  }

  bool is_usable(const PathSample& sample, const PixelSample& which) {
    if (is_finite(sample)) return true;
    add(report_, {.non_finite_samples = 1, .first_non_finite = which});
    return false;
  }

  const FrameSetup& setup_;
  const bool splits_;
  RadianceSplit split_;  // of one sample
  PixelStatistics statistics_;
  SplitStatistics split_statistics_;
  PathContext context_, guides_context_;
  RenderReport report_;
};

/// Renders all pixels of the frame, tile by tile; false if cancelled.
bool render_tiles(const FrameSetup& setup, const RenderOptions& options, Frame& frame, RenderReport& total) {
  const std::vector<Tile> tiles = make_tiles(setup.width, setup.height, options.tile_px);
  if (options.rays != nullptr) options.rays->assign(tiles.size(), {});
  const auto cancelled = [&] {
    return options.cancel != nullptr && options.cancel->load(std::memory_order_relaxed);
  };
  std::mutex total_mutex;
  std::atomic<std::size_t> pixels_done{0};
  const auto render_tile = [&](std::size_t number) {
    const Tile& tile = tiles[number];
    PixelRenderer renderer(setup, wants_split(options),
                           options.rays != nullptr ? &(*options.rays)[number] : nullptr);
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        if (cancelled()) return;
        renderer.render(x, y, frame);
      }
    }
    {
      const std::lock_guard lock(total_mutex);
      add(total, renderer.report());
    }
    const std::size_t done = pixels_done += tile.pixels();
    if (options.progress)
      options.progress(static_cast<double>(done) / (std::size_t(setup.width) * setup.height));
  };
  tbb::parallel_for(std::size_t{0}, tiles.size(), render_tile, tbb::simple_partitioner());
  return !cancelled();
}

}  // namespace

std::optional<Frame> render_frame(Scene& scene, int frame_number, const RenderOptions& options,
                                  RenderReport* report) {
  const auto start = std::chrono::steady_clock::now();
  check(options);
  const FrameSetup setup(scene, frame_number, options);
  if (options.sample_counts != nullptr) check_size(*options.sample_counts, setup.width, setup.height);
  Frame frame = make_frame(setup, options);
  RenderReport total;
  if (!render_tiles(setup, options, frame, total)) return std::nullopt;
  setup.description.textures.check();
  total.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report != nullptr) *report = total;
  return frame;
}

std::vector<std::string> describe_sample(Scene& scene, int frame_number, const RenderOptions& options,
                                         const PixelSample& which) {
  check(options);
  const FrameSetup setup(scene, frame_number, options);
  if (options.sample_counts != nullptr) check_size(*options.sample_counts, setup.width, setup.height);
  constexpr std::uint32_t samples = kMostSamples;  // adaptive frames have more than `spp` in some pixels
  if (which.x < 0 || which.x >= setup.width || which.y < 0 || which.y >= setup.height ||
      which.sample >= samples) {
    throw Error(ExitStatus::usage,
                fmt::format("debug-pixel: {},{},{}: the frame has {}x{} pixels of {} samples at most",
                            which.x, which.y, which.sample, setup.width, setup.height, samples));
  }
  std::vector<PathVertex> path;
  PathContext context = setup.context();
  context.log = &path;
  const PathSample sample = setup.sample_pixel(context, which.x, which.y, which.sample);
  setup.description.textures.check();

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
