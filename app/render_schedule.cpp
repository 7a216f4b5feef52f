#include "app/render_schedule.h"

#include <algorithm>
#include <cstdint>

#include "app/input_frames.h"
#include "frame/io/frame_range.h"

namespace becalm::app {
namespace {

/// Those of the scene at this distance from the first one asked for, and those that are named.
std::vector<int> renderable(const std::vector<int>& asked, const std::vector<int>& context, int first,
                            int last, int step) {
  std::set<int> frames(asked.begin(), asked.end());
  for (int frame = first; frame <= last; ++frame) {
    if ((std::int64_t{frame} - asked.front()) % step == 0) frames.insert(frame);
  }
  frames.insert(context.begin(), context.end());
  return {frames.begin(), frames.end()};
}

}  // namespace

std::set<int> frames_in(const std::vector<filter::Segment>& segments) {
  std::set<int> frames;
  for (const filter::Segment& segment : segments) {
    for (const filter::Step& step : segment) frames.insert(step.frame);
  }
  return frames;
}

RenderSchedule::RenderSchedule(const FilterStage& filter, const std::vector<int>& asked, int step, int first,
                               int last)
    : filter_(filter),
      readable_(filter.readable(asked, renderable(asked, filter.context_frames(), first, last, step))),
      step_(usual_step(readable_)) {
  // Frames that --context names have a distance of their own.
  if (filter.has_segments() && filter.context_frames().empty()) step_ = std::min(step_, step);
}

std::vector<filter::Segment> RenderSchedule::segments(const std::vector<int>& work) const {
  return filter_.schedule(readable_, {work.begin(), work.end()}, step_);
}

std::string RenderSchedule::made_from(int frame) const {
  const std::set<int> frames = frames_in(segments({frame}));
  return io::format_frame_range({frames.begin(), frames.end()});
}

}  // namespace becalm::app
