#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>

#include "frame/frame.h"
#include "tracer/scene/scene.h"

namespace becalm::tracer {

struct RenderOptions {
  int width = 0;    ///< 0: the scene's
  int height = 0;
  int spp = 8;      ///< samples per pixel, 1..65536
  std::uint32_t seed = 0;
  AovSet aovs;      ///< besides the beauty
  int tile_px = 32;
  /// Called from worker threads as tiles finish, with the share of the frame done in [0,1].
  std::function<void(double)> progress;
  /// Rendering stops soon after this becomes true.
  const std::atomic<bool>* cancel = nullptr;
};

struct RenderReport {
  double seconds = 0.0;
  std::uint64_t samples = 0;
  std::size_t non_finite_samples = 0;  ///< samples with NaN or Inf: dropped, counted, replayable by the printed flag
};

/// Renders one frame of the scene; nothing if cancelled. The image is a pure function of (scene, frame, size, spp,
/// seed): it does not depend on threads, tiles or what was rendered before. Threads follow the caller's
/// tbb::global_control.
std::optional<Frame> render_frame(Scene& scene, int frame, const RenderOptions& options,
                                  RenderReport* report = nullptr);

}  // namespace becalm::tracer
