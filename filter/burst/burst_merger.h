#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "filter/gpu/device.h"
#include "filter/report.h"
#include "filter/settings.h"
#include "frame/mosaic.h"

namespace becalm::filter {

/// The aligner's settings for bursts: distance l1, patches that grow with the resolution as noise asks for.
Settings burst_aligner_settings();

/// A frame of a burst, whose mosaic is scaled to the reference's exposure.
struct BurstFrame {
  const Image& samples;    ///< one channel, of the merger's size; 0 is black
  NoiseModel noise;        ///< of the scaled samples
  float saturated = 1.0f;  ///< samples of this value or more are saturated
};

/// Merges the mosaics of a burst into one of them, frame by frame (Hanika et al. 2021, section 4): memory
/// does not grow with their number. Samples that are not finite count as saturated.
class BurstMerger {
 public:
  /// Throws DeviceLimitError if the device, or `memory_limit`, cannot hold what is needed.
  BurstMerger(gpu::Device& device, const Settings& aligner, const CfaPattern& cfa, int width, int height,
              std::uint64_t memory_limit);
  ~BurstMerger();
  BurstMerger(BurstMerger&&) noexcept;

  /// Begins a burst. `white_balance` makes grey of white light.
  void start(const BurstFrame& reference, const std::array<float, 3>& white_balance);
  /// Merges one more frame. Adds the device times to the report.
  void add(const BurstFrame& frame, FrameReport& report);
  /// For tests: where the last frame's samples came from: two channels, a pixel a block, in pixels of the
  /// mosaic.
  Image offset() const;
  int block() const;

  /// The mosaic so far.
  Image merged() const;
  /// The sum of all frames' weights, the reference's being 1, averaged over pixels: by what factor the merge
  /// lowers the variance of the reference.
  double mean_weight() const;
  FilterMemory memory() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
