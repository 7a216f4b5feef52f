#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "frame/frame.h"
#include "tracer/path_trace.h"

namespace becalm::tracer {

/// The id that most samples gave: ids cannot be averaged.
class MajorityVote {
 public:
  void add(std::uint32_t number);
  /// The least of those with the most votes; 0 without votes.
  std::uint32_t winner() const;
  void clear() { votes_.clear(); }

 private:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> votes_;  ///< number, count
};

/// The parts of the radiance that the samples of a pixel add up to, in double.
class SplitStatistics {
 public:
  explicit SplitStatistics(std::size_t group_count) : groups_(group_count, V3d(0.0)) {}
  void clear();
  void add(const RadianceSplit& split);
  /// Writes what the frame has images for.
  void write(Frame& frame, int x, int y) const;

 private:
  std::uint32_t count_ = 0;
  V3d direct_{0.0}, indirect_{0.0};
  std::vector<V3d> groups_;
};

/// Everything that one pixel's samples add up to, in double. All samples weigh the same. One serves a whole
/// tile, so that the votes' memory is allocated once.
class PixelStatistics {
 public:
  /// Ready for the next pixel, of so many samples.
  void clear(std::uint32_t spp) {
    sums_ = {};
    half_ = (spp + 1) / 2;
    block_mask_ = block_samples(spp) - 1;
    objects_.clear();
    materials_.clear();
  }

  /// Of the sample with that index; indices rise.
  void add(const PathSample& sample, std::uint32_t index) {
    if ((index & block_mask_) == 0) close_block();
    const V3d radiance(sample.radiance);
    ++sums_.block_count;
    sums_.block_sum += radiance;
    // Aligned blocks of the sampler's sequence are stratified, so the halves are the first and the second,
    // not odd and even.
    const int half = index < half_ ? 0 : 1;
    ++sums_.half_count[half];
    sums_.half_sum[half] += radiance;
    sums_.covered += sample.covered ? 1.0 : 0.0;
  }
  void add_guides(const Guides& guides) {
    ++sums_.guide_count;
    objects_.add(guides.ids.object);
    materials_.add(guides.ids.material);
    sums_.albedo += V3d(guides.albedo);
    sums_.normal += V3d(guides.normal);
    sums_.motion += V2d(guides.motion);
    if (std::isfinite(guides.depth)) {
      sums_.depth += guides.depth;
      ++sums_.depth_count;
    }
  }

  /// Writes what the frame has images for. A pixel without samples becomes black, uncovered and of no motion.
  void write(Frame& frame, int x, int y);

 private:
  /// Samples of a block, a power of two: the variance of a pixel's mean is told from the spread of blocks'
  /// means. Samples of a block are stratified, and so is the pixel's mean; single samples spread more. About
  /// as many blocks as samples in each.
  static std::uint32_t block_samples(std::uint32_t spp) {
    return spp > 0 ? 1u << ((std::bit_width(spp) - 1) / 2) : 1;
  }
  void close_block();
  V3d variance_of_mean() const;

  struct Sums {
    std::uint32_t count = 0;
    std::uint32_t half_count[2] = {0, 0};
    std::uint32_t guide_count = 0;
    std::uint32_t depth_count = 0;
    std::uint32_t blocks = 0;  ///< closed ones
    std::uint32_t block_count = 0;
    V3d block_sum{0.0};
    V3d mean{0.0};     ///< of closed blocks' samples
    V3d squares{0.0};  ///< of blocks' differences from the mean, weighted by their samples (West 1979)
    V3d half_sum[2] = {V3d(0.0), V3d(0.0)};
    V3d albedo{0.0}, normal{0.0};
    V2d motion{0.0};
    double depth = 0.0;
    double covered = 0.0;
  };
  Sums sums_;
  std::uint32_t half_ = 0;        ///< samples of the first half
  std::uint32_t block_mask_ = 0;  ///< an index that has none of these bits begins a block
  MajorityVote objects_, materials_;
};

}  // namespace becalm::tracer
