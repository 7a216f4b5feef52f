#include "app/measure_frames.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <utility>

#include "app/cancel.h"

namespace becalm::app {
namespace {

struct Work {
  std::shared_ptr<const ComparedFrame> now;
  std::shared_ptr<const ComparedFrame> before;
  FrameFigures figures;
};

/// Besides these, the last frame that was read is kept, for the temporal error of the next.
std::size_t frames_at_once(const ComparedFrame& frame) {
  constexpr std::size_t most_bytes = 2'000'000'000;
  std::size_t values = 0;
  for (const Image* image : {&frame.test, &frame.reference, &frame.reference_b, &frame.reference_mean}) {
    values += image->data().size();
  }
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  return std::clamp(most_bytes / (values * sizeof(float)), std::size_t{1}, threads);
}

}  // namespace

void measure_frames(const std::vector<int>& frames, int step, const std::function<ComparedFrame(int)>& read,
                    const std::function<void(const MeasuredFrame&)>& done) {
  if (frames.empty() || stop_requested()) return;
  auto ahead = std::make_shared<const ComparedFrame>(read(frames.front()));
  const std::size_t at_once = frames_at_once(*ahead);
  auto next = frames.begin() + 1;
  std::shared_ptr<const ComparedFrame> last;
  std::exception_ptr failure;
  const auto read_next = [&](tbb::flow_control& control) -> Work {
    try {
      std::shared_ptr<const ComparedFrame> now = std::exchange(ahead, nullptr);
      if (!now && next != frames.end() && !stop_requested()) {
        now = std::make_shared<const ComparedFrame>(read(*next++));
      }
      if (now) return {.now = now, .before = std::exchange(last, now), .figures = {}};
    } catch (...) {
      failure = std::current_exception();
    }
    control.stop();
    return {};
  };
  const auto measured = [step](Work work) {
    work.figures = measure(*work.now, work.before.get(), step);
    work.before = nullptr;
    return work;
  };
  const auto finish = [&](const Work& work) { done({work.figures, *work.now}); };
  tbb::parallel_pipeline(at_once,
                         tbb::make_filter<void, Work>(tbb::filter_mode::serial_in_order, read_next) &
                             tbb::make_filter<Work, Work>(tbb::filter_mode::parallel, measured) &
                             tbb::make_filter<Work, void>(tbb::filter_mode::serial_in_order, finish));
  if (failure) std::rethrow_exception(failure);
}

}  // namespace becalm::app
