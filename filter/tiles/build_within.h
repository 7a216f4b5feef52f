#pragma once

#include <cstdint>
#include <optional>

#include "filter/gpu/device.h"

namespace becalm::filter {

/// Device memory that all filters together may take, in bytes.
std::uint64_t usable_bytes(const gpu::Device& device);

/// Calls `build(limit)`, which plans chains for `limit` bytes and builds them. If that throws
/// DeviceMemoryError, since other programs hold memory, calls it again with half of the limit, so that tiles
/// get smaller. If no plan fits, throws the last DeviceMemoryError, or the DeviceLimitError if there was
/// none.
template <class Build>
void build_within(std::uint64_t limit, const Build& build) {
  std::optional<gpu::DeviceMemoryError> missing;
  for (;; limit /= 2) {
    try {
      build(limit);
      return;
    } catch (const gpu::DeviceMemoryError& error) {
      missing = error;
      if (limit == 0) throw;
    } catch (const gpu::DeviceLimitError&) {
      if (missing) throw *missing;
      throw;
    }
  }
}

}  // namespace becalm::filter
