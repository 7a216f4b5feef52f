#pragma once

#include <atomic>
#include <optional>

#include "app/options.h"
#include "filter/gpu/device.h"
#include "filter/sequence/sequence_filter.h"
#include "tracer/render.h"
#include "tracer/sample_counts.h"

namespace becalm::app {

/// Adaptive sampling: a pilot of each frame, of half the size and of two samples a pixel, is filtered by
/// itself, and its pixels' expected errors say where the frame needs samples. The pilot has another seed and
/// its samples are not used again, so that the frame stays unbiased; no frame's counts depend on other
/// frames, so that a job may be cut anywhere.
class AdaptiveSampling {
 public:
  struct Options {
    std::optional<double> noise_target;  ///< relative; else `spp` is the mean of every frame
    int spp = 8;                         ///< the mean, or with a target the most
    bool halves = false;                 ///< every pixel has at least two samples
  };

  /// `render` is how the frames are rendered, but for the numbers of samples.
  AdaptiveSampling(tracer::Scene& scene, tracer::RenderOptions render, const FilterOptions& filter,
                   const Options& options);

  /// Samples of each pixel of a frame; nothing if a stop was requested.
  std::optional<Image> counts(int frame);

  /// The pilot of a frame as it was rendered, for those who want to know what samples cost.
  std::optional<Frame> render_pilot(int frame, tracer::RenderReport* report = nullptr);

  /// What a noise target took, summed over the frames.
  struct Spent {
    double frames = 0.0;
    double spp = 0.0;     ///< their means
    double capped = 0.0;  ///< the shares of their pixels that have the most samples
  };
  const Spent& spent() const { return spent_; }

  /// Samples that a pilot takes per pixel of the frame.
  static double pilot_spp();

 private:
  void add_spent(const Image& counts, int most);

  tracer::Scene& scene_;
  const int width_, height_;
  tracer::RenderOptions pilot_options_;
  const Options options_;
  const MemoryLimit memory_limit_;
  const gpu::DeviceOptions device_options_;
  std::optional<gpu::Device> device_;
  std::optional<filter::SequenceFilter> filter_;
  Spent spent_;
};

}  // namespace becalm::app
