#include "filter/report.h"

#include <fmt/format.h>

#include <algorithm>

namespace becalm::filter {

void add_times(FrameReport& report, const gpu::Chain& chain) {
  for (const gpu::PassTime& pass : chain.times()) {
    const auto same = std::ranges::find(report.passes, pass.name, &gpu::PassTime::name);
    if (same == report.passes.end()) {
      report.passes.push_back(pass);
    } else {
      same->milliseconds += pass.milliseconds;
    }
  }
}

void add_memory(FilterMemory& memory, const gpu::Chain& chain) {
  memory.device += chain.device_bytes();
  memory.device_bytes_unaliased += chain.device_bytes_unaliased();
  memory.staging_bytes += chain.staging_bytes();
}

FilterMemory& FilterMemory::operator+=(const FilterMemory& part) {
  device += part.device;
  device_bytes_unaliased += part.device_bytes_unaliased;
  staging_bytes += part.staging_bytes;
  return *this;
}

void add_memory(FilterMemory& memory, const FilterMemory& part, const std::string& name) {
  memory += part;
  if (part.tiles == 1) return;
  memory.tile_plan =
      fmt::format("{}{} {}", memory.tile_plan == "1" ? "" : memory.tile_plan + "; ", name, part.tile_plan);
}

}  // namespace becalm::filter
