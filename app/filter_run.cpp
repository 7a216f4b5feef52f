#include "app/filter_run.h"

#include <future>
#include <optional>
#include <utility>

#include "app/cancel.h"
#include "app/stage.h"

namespace becalm::app {

void run_filter(FilterStep& filter, std::span<const filter::Step> steps, const FilterFiles& files,
                const std::function<void(std::size_t step)>& on_step, Progress& progress, Profile& profile) {
  Stage<DenoisedFile> writer(1, files.write, request_stop);
  const auto start_reading = [&](std::size_t step) {
    return std::async(std::launch::async, files.read, steps[step].frame);
  };
  std::future<io::LoadedFrame> next = start_reading(0);
  for (std::size_t i = 0; i < steps.size() && !stop_requested(); ++i) {
    io::LoadedFrame loaded = next.get();
    if (i + 1 < steps.size()) next = start_reading(i + 1);
    on_step(i);
    std::optional<Frame> denoised = filter.run(steps[i], loaded.frame, progress, profile);
    std::vector<Frame> other_views;
    for (std::size_t view = 0; view < loaded.other_views.size(); ++view) {
      std::optional<Frame> other =
          filter.run(steps[i], loaded.other_views[view].frame, progress, profile, view + 1);
      if (other) other_views.push_back(std::move(*other));
    }
    if (denoised) writer.push({std::move(*denoised), std::move(other_views), std::move(loaded)});
  }
  writer.finish();
}

}  // namespace becalm::app
