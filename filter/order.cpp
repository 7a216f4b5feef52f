#include "filter/order.h"

#include <algorithm>
#include <utility>

#include "filter/frame_check.h"
#include "filter/host_images.h"
#include "filter/tiled_frame.h"
#include "filter/whole_frame.h"

namespace becalm::filter {
namespace {

/// Share of the device's memory that the filter may take: the driver and others need some, too.
constexpr double kShareOfDevice = 0.9;

std::unique_ptr<FrameMerger> make_merger(gpu::Device& device, const FilterTask& task,
                                         std::uint64_t memory_limit) {
  const auto of_device =
      static_cast<std::uint64_t>(kShareOfDevice * static_cast<double>(device.info().memory_bytes));
  const std::uint64_t limit = std::min(memory_limit, of_device);
  try {
    auto whole = std::make_unique<WholeFrame>(device, task);
    if (whole->memory().device_bytes <= limit) {
      whole->build();
      return whole;
    }
  } catch (const gpu::DeviceLimitError&) {
    // An image is too large for the device: tiles are smaller.
  }
  return std::make_unique<TiledFrame>(device, task, limit);
}

}  // namespace

AovSet wanted_aovs(const Settings& settings) {
  AovSet wanted;
  const auto want = [&](Aov aov, bool needed) { wanted.set(static_cast<std::size_t>(aov), needed); };
  want(Aov::albedo, settings.weight_albedo > 0.0f);
  want(Aov::normal, settings.weight_normal > 0.0f || (settings.validate & validate_normal) != 0);
  want(Aov::depth, (settings.validate & validate_depth) != 0);
  want(Aov::object_id, (settings.validate & validate_id) != 0);
  want(Aov::motion, settings.motion != MotionUse::none);
  for (const Aov aov : {Aov::variance, Aov::half_a, Aov::half_b}) want(aov, true);
  return wanted;
}

struct ForwardFilter::State {
  FilterTask task;
  std::unique_ptr<FrameMerger> merger;
};

ForwardFilter::ForwardFilter(gpu::Device& device, const Settings& settings, int width, int height,
                             AovSet available, AovSet diagnostics, std::uint64_t memory_limit)
    : state_(std::make_unique<State>()) {
  const AovSet used = available & wanted_aovs(settings);
  state_->task = {.settings = settings,
                  .full = {width, height},
                  .used = used,
                  .diagnostics = diagnostics,
                  .guides = guides_of(settings, used)};
  if (!state_->task.guides.albedo) state_->task.settings.demodulate = 0;  // nothing to divide out
  state_->merger = make_merger(device, state_->task, memory_limit);
}
ForwardFilter::~ForwardFilter() = default;
ForwardFilter::ForwardFilter(ForwardFilter&&) noexcept = default;

Denoised ForwardFilter::denoise(const Frame& frame) {
  const FilterTask& task = state_->task;
  check_frame(frame, task.full.width, task.full.height, task.used, "the frames before it");
  const Image& beauty = frame.image(Aov::beauty);
  const NewFrame new_frame{.frame = frame, .finite = finite_pixels(beauty), .exposure = exposure(beauty)};

  Denoised result{Frame(frame.number(), frame.width(), frame.height()), {}};
  result.frame.add(Aov::beauty);
  result.frame.add(Aov::variance);
  for (const AovInfo& entry : kAovTable) {
    if (entry.diagnostic && contains(task.diagnostics, entry.aov)) result.frame.add(entry.aov);
  }
  FrameReport& report = result.report;
  report.non_finite_pixels = static_cast<std::size_t>(std::ranges::count(new_frame.finite, 0));
  state_->merger->merge(new_frame, result);
  report.mean_rejected /= static_cast<double>(beauty.pixel_count());
  report.mean_sample_count /= static_cast<double>(beauty.pixel_count());
  return result;
}

void ForwardFilter::reset() {
  state_->merger->reset();
}

FilterMemory ForwardFilter::memory() const {
  return state_->merger->memory();
}

}  // namespace becalm::filter
