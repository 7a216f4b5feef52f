#pragma once

#include <cstdint>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/smooth/frame_smoother.h"
#include "filter/task.h"

namespace becalm::filter {

/// Smooths the albedo of a frame by a small network of its own. Where a surface is glossy, or blurred by a
/// lens or by motion, renderers write the albedo as noisy as the radiance, and dividing by it adds that
/// noise. Noisy alpha is like the albedo of a white surface.
class AlbedoSmoother {
 public:
  /// As FrameSmoother's constructor.
  AlbedoSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);

  /// The smoothed albedo, RGB in [0,1]. A non-finite pixel counts as pack_albedo has it.
  Image smooth(const NewFrame& frame, FrameReport& report);
  /// Replaces the alpha of `merged`, an RGBA image made of the frame and others, by the smoothed one, in
  /// [0,1].
  void smooth_alpha(const NewFrame& frame, Image& merged, FrameReport& report);
  FilterMemory memory() const { return smoother_.memory(); }

 private:
  /// Smooths `albedo`, RGBA in [0,1], with the frame's normal and depth.
  Image smooth(const NewFrame& frame, Image albedo, FrameReport& report);

  FilterTask task_;
  FrameSmoother smoother_;
};

}  // namespace becalm::filter
