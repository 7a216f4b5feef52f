#pragma once

#include <cstdint>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/local_chain.h"

namespace becalm::filter {

/// Smooths frames by the network: single ones, so that offsets and merge weights depend little on noise; as
/// the task says, merged ones or albedos.
class FrameSmoother {
 public:
  /// Plans the largest tiles that take at most `memory_limit` bytes. Throws DeviceLimitError if even the
  /// smallest tiles take more.
  FrameSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);
  ~FrameSmoother();

  /// Returns the smoothed colour, with (remaining variance; 1, or 0 for a non-finite pixel) and, if the task
  /// hands it on, the noise.
  Estimate smooth(const NewFrame& frame, FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Passes;
  void choose_network(float noise_ratio);

  FilterTask task_;
  float shared_noise_ = 0.0f;  ///< of the weights: 0 for independent noise, 1 for noise that neighbours share
  LocalChain<Passes> chain_;
};

}  // namespace becalm::filter
