#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "frame/frame.h"
#include "tracer/path_trace.h"
#include "tracer/snapshot/scene.h"

namespace becalm::tracer {

struct RenderOptions {
  int width = 0;  ///< 0: the scene's
  int height = 0;
  int spp = 8;  ///< samples per pixel, 1..kMostSamples
  /// Samples of each pixel, 1..kMostSamples, in place of spp: one channel, of the frame's size. The frame is
  /// unbiased as long as the counts do not come from its own samples (Kirk and Arvo 1991).
  const Image* sample_counts = nullptr;
  /// Samples per pixel of the AOVs of what is seen (albedo, normal, depth, motion, object_id, material_id) if
  /// more than the pixel's samples, up to kMostSamples. Those beyond them end at the surface and find no
  /// light.
  int aov_spp = 0;
  /// Samples go to every other pixel: of frames of even numbers those whose x + y is even, of others the
  /// rest, which stay as where nothing is hit. Two frames then share a position of the jitter.
  bool checkerboard = false;
  std::uint32_t seed = 0;
  /// Of a camera with two; the random numbers of the eyes differ.
  Eye eye = Eye::centre;
  AovSet aovs;  ///< besides the beauty
  bool light_groups = false;
  int tile_px = 32;
  /// For benchmarks: the integrator in place of the one that the scene needs.
  const PathVariant* variant = nullptr;
  /// For benchmarks: becomes the ray queries of each tile in their order, 48 bytes a ray.
  std::vector<std::vector<RecordedRay>>* rays = nullptr;
  /// Called from worker threads as tiles finish, with the share of the frame done in [0,1].
  std::function<void(double)> progress;
  /// Rendering stops soon after this becomes true.
  const std::atomic<bool>* cancel = nullptr;
};

/// One sample of one pixel: `--debug-pixel x,y,sample`.
struct PixelSample {
  int x = 0;
  int y = 0;
  std::uint32_t sample = 0;
  friend bool operator<(const PixelSample& a, const PixelSample& b) {
    return std::tie(a.x, a.y, a.sample) < std::tie(b.x, b.y, b.sample);
  }
};

struct RenderReport {
  double seconds = 0.0;
  std::uint64_t samples = 0;
  /// Samples with NaN or Inf: dropped, counted, replayable by the printed flag.
  std::size_t non_finite_samples = 0;
  std::optional<PixelSample> first_non_finite;  ///< the least of them by x, y, sample
};

/// Renders one frame of the scene; nothing if cancelled. The image is a pure function of (scene, frame, size,
/// spp or sample_counts, aov_spp, checkerboard, seed, eye): it does not depend on threads, tiles, which other
/// AOVs are asked for or what was rendered before. Threads follow the caller's tbb::global_control.
///
/// The variance is that of the pixel's mean, from the samples themselves; of a single sample, its square.
/// Radiance, albedo, normal and motion are means over the samples, depth over those that hit something.
/// AOVs of what is seen have the beauty's samples and, up to aov_spp, more of the same sequence.
/// Samples that are not finite are left out of all of them. Throws Error(usage) for numbers of samples out of
/// range, sample_counts of another size, or halves of a single sample; Error(bad_input) as Scene::at_frame
/// does and for textures whose pixels cannot be read.
std::optional<Frame> render_frame(Scene& scene, int frame, const RenderOptions& options,
                                  RenderReport* report = nullptr);

/// The path of one sample in lines of text: every surface met, the throughput on arrival, the radiance so
/// far. Throws as render_frame does.
std::vector<std::string> describe_sample(Scene& scene, int frame, const RenderOptions& options,
                                         const PixelSample& which);

}  // namespace becalm::tracer
