#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace becalm::filter {

/// Values converted at one time: whole pixels of 1, 2, 3 or 4 channels.
inline constexpr std::size_t kHalfBlock = 24;

/// One factor per channel, repeated over a block.
class ChannelFactors {
 public:
  /// `of_channels` has one to four.
  explicit ChannelFactors(const std::vector<float>& of_channels) {
    for (std::size_t i = 0; i < kHalfBlock; ++i) factors_[i] = of_channels[i % of_channels.size()];
  }
  const float* data() const { return factors_.data(); }

 private:
  std::array<float, kHalfBlock> factors_{};
};

/// Writes a block of values, multiplied by the factors, as half floats. Bit i of the result is set if half i,
/// divided by its factor, has a relative error above `largest_error` or is not a number.
std::uint32_t to_halves(const float* values, const ChannelFactors& factors, float largest_error,
                        std::uint16_t* halves);
/// The halves of a block over the factors.
void from_halves(const std::uint16_t* halves, const ChannelFactors& factors, float* values);

}  // namespace becalm::filter
