#include "filter/gpu/profiler.h"

#include "filter/gpu/profiler_impl.h"

namespace becalm::gpu {

PassTimer::PassTimer(const Device::Impl& device, std::uint32_t passes)
    : passes_(passes), milliseconds_per_tick_(device.limits.timestampPeriod * 1e-6) {
  if (device.timestamp_bits == 0 || passes == 0) return;
  valid_bits_ = ~std::uint64_t{0} >> (64 - device.timestamp_bits);
  pool_ = {device.device, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, 2 * passes)};
}

void PassTimer::reset(const vk::raii::CommandBuffer& commands) const {
  if (valid_bits_ != 0) commands.resetQueryPool(*pool_, 0, 2 * passes_);
}

void PassTimer::stamp(const vk::raii::CommandBuffer& commands, std::uint32_t query) const {
  // After all earlier commands, so that a pass's time does not include the end of the previous pass.
  if (valid_bits_ != 0) commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *pool_, query);
}

double PassTimer::milliseconds(std::uint32_t pass) const {
  if (valid_bits_ == 0) return 0.0;
  const auto [result, ticks] =
      pool_.getResults<std::uint64_t>(2 * pass, 2, 2 * sizeof(std::uint64_t), sizeof(std::uint64_t),
                                      vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
  const std::uint64_t elapsed = (ticks[1] - ticks[0]) & valid_bits_;  // also correct if the counter wraps
  return static_cast<double>(elapsed) * milliseconds_per_tick_;
}

}  // namespace becalm::gpu
