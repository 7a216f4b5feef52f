#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/gpu/image.h"
#include "filter/gpu/profiler.h"
#include "filter/settings.h"
#include "frame/image.h"

namespace becalm::bench {

/// Images of one frame by layer name ("beauty", "albedo", "normal", or "plane" alone).
using Layers = std::map<std::string, Image>;

/// An aligner built for one size and one set of settings, and the pair of images that it aligns.
class AlignJob {
 public:
  virtual ~AlignJob() = default;

  virtual void load(const Layers& target, const Layers& source) = 0;
  /// Before each run; what a run's time does not include.
  virtual void prepare() {}
  /// Aligns once and waits. Throws Error(bad_input) if a layer that it matches was not loaded.
  virtual void run() = 0;

  /// Of the last run.
  virtual std::vector<gpu::PassTime> passes() const = 0;
  virtual Image offset() const = 0;
  virtual Image residual() const = 0;  ///< of the finest level

  virtual std::uint64_t device_bytes() const = 0;
  virtual std::uint64_t device_bytes_unaliased() const = 0;
};

/// Aligns whole frames by filter::PairAligner: its features come from radiance and guides, and its time
/// includes packing on the host.
std::unique_ptr<AlignJob> make_frame_job(gpu::Device& device, const filter::Settings& settings,
                                         gpu::Extent full, const std::vector<std::string>& aovs);

/// Aligns one plane with values in [0,1] per frame, uploaded at full resolution: the input of other aligners.
std::unique_ptr<AlignJob> make_plane_job(gpu::Device& device, const filter::Settings& settings,
                                         gpu::Extent full, bool alias_memory);

}  // namespace becalm::bench
