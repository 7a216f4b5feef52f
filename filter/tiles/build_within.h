#pragma once

#include <cstdint>
#include <optional>

#include "filter/gpu/device.h"

namespace becalm::filter {

/// Device memory that all filters together may take, in bytes.
std::uint64_t usable_bytes(const gpu::Device& device);

/// Calls `build(limit)`, which plans chains for `limit` bytes and builds them. If memory is used up before
/// that, as other programs hold some, again for half of the bytes, so that tiles get smaller. Passes on
/// DeviceLimitError: of the memory that was missing, if smaller tiles cannot be planned.
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
