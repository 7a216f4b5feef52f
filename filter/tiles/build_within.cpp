#include "filter/tiles/build_within.h"

namespace becalm::filter {
namespace {

/// Share of the device's memory that filters may take; the driver and other programs need the rest.
constexpr double kShareOfDevice = 0.9;

}  // namespace

std::uint64_t usable_bytes(const gpu::Device& device) {
  return static_cast<std::uint64_t>(kShareOfDevice * static_cast<double>(device.info().memory_bytes));
}

}  // namespace becalm::filter
