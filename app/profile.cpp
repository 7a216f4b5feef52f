#include "app/profile.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>

#include "app/console.h"
#include "frame/mebibytes.h"

namespace becalm::app {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void Profile::add(const std::string& step, double seconds) {
  const std::lock_guard lock(mutex_);
  find(steps_ms_, step).push_back(seconds * 1e3);
}

void Profile::add(const std::vector<gpu::PassTime>& passes) {
  const std::lock_guard lock(mutex_);
  for (const gpu::PassTime& pass : passes) find(passes_ms_, pass.name).push_back(pass.milliseconds);
}

void Profile::set_device(std::string name, const filter::FilterMemory& memory) {
  const std::lock_guard lock(mutex_);
  device_ = std::move(name);
  memory_ = memory;
}

void Profile::print() const {
  const std::lock_guard lock(mutex_);
  print_table("wall time a frame", steps_ms_);
  print_table("device time a frame", passes_ms_);
  if (!device_.empty()) {
    say(fmt::format(
        "device {}: {} of {}x{} px, {:.1f} MiB held ({:.1f} MiB without shared memory), {:.1f} MiB of host "
        "memory for transfers",
        device_, memory_.tiles == 1 ? "1 tile" : fmt::format("{} tiles", memory_.tiles), memory_.tile.width,
        memory_.tile.height, mebibytes(memory_.device.total()), mebibytes(memory_.device_bytes_unaliased),
        mebibytes(memory_.staging_bytes)));
  }
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  say(fmt::format("peak resident memory: {:.1f} MiB", static_cast<double>(usage.ru_maxrss) / 1024.0));
}

std::vector<double>& Profile::find(Samples& samples, const std::string& name) {
  const auto found =
      std::find_if(samples.begin(), samples.end(), [&](const auto& entry) { return entry.first == name; });
  return found != samples.end() ? found->second : samples.emplace_back(name, std::vector<double>()).second;
}

void Profile::print_table(const char* title, const Samples& samples) {
  if (samples.empty()) return;
  say(fmt::format("{} (median over the frames):", title));
  double total_ms = 0.0;
  for (const auto& [name, values] : samples) {
    const double value = median(values);
    total_ms += value;
    say(fmt::format("  {:<48} {:>10.2f} ms", name, value));
  }
  say(fmt::format("  {:<48} {:>10.2f} ms", "sum", total_ms));
}

}  // namespace becalm::app
