#include "app/pipeline.h"

#include <future>
#include <utility>

#include "app/cancel.h"

namespace becalm::app {

void run_pipeline(std::size_t steps, const Stages& stages) {
  // Outside the try block: their destructors wait for the other threads, which must know by then that they
  // are to stop.
  std::future<std::optional<io::LoadedFrame>> made;
  std::future<void> written;
  const auto start_source = [&](std::size_t step) {
    made = std::async(std::launch::async, stages.source, step);
  };
  const auto sink = [&stages](FinishedFrame frame) {
    try {
      stages.sink(std::move(frame));
    } catch (...) {
      request_stop();
      throw;
    }
  };
  try {
    if (steps > 0) start_source(0);
    if (stages.prepare) stages.prepare();
    for (std::size_t step = 0; step < steps; ++step) {
      std::optional<io::LoadedFrame> noisy = made.get();
      if (!noisy || stop_requested()) break;
      if (step + 1 < steps) start_source(step + 1);
      std::optional<FinishedFrame> finished = stages.filter(step, std::move(*noisy));
      if (written.valid()) written.get();
      if (!finished) continue;
      written = std::async(std::launch::async, sink, std::move(*finished));
    }
    if (written.valid()) written.get();
  } catch (...) {
    request_stop();
    throw;
  }
}

FinishedFrame unfiltered(io::LoadedFrame noisy) {
  const auto take_beauty = [](Frame& from) {
    Frame frame(from.number(), from.width(), from.height());
    frame.set_jitter(from.jitter());
    frame.set_checkerboard(from.checkerboard());
    frame.image(Aov::beauty) = std::move(from.image(Aov::beauty));
    return frame;
  };
  FinishedFrame finished{.frame = take_beauty(noisy.frame), .other_views = {}, .source = {}};
  for (io::LoadedView& view : noisy.other_views) finished.other_views.push_back(take_beauty(view.frame));
  finished.source = std::move(noisy);
  return finished;
}

}  // namespace becalm::app
