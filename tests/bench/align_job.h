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

/// An aligner built for one size and one set of settings, with the pair that it works on.
class AlignJob {
 public:
  virtual ~AlignJob() = default;

  virtual void load(const Layers& target, const Layers& source) = 0;
  /// Aligns once and waits. Throws Error(bad_input) if a layer that is matched was not loaded.
  virtual void run() = 0;

  /// Of the last run.
  virtual std::vector<gpu::PassTime> passes() const = 0;
  virtual Image offset() const = 0;
  virtual Image residual() const = 0;  ///< of the finest level

  virtual std::uint64_t device_bytes() const = 0;
  virtual std::uint64_t device_bytes_unaliased() const = 0;
};

/// Whole frames through filter::PairAligner: features from radiance and guides, host packing included.
std::unique_ptr<AlignJob> make_frame_job(gpu::Device& device, const filter::Settings& settings,
                                         gpu::Extent full, const std::vector<std::string>& aovs);

/// One plane a frame in [0,1], uploaded at full resolution: what other aligners work on, too.
std::unique_ptr<AlignJob> make_plane_job(gpu::Device& device, const filter::Settings& settings,
                                         gpu::Extent full, bool alias_memory);

}  // namespace becalm::bench
