#include "app/render_ahead.h"

#include <map>
#include <set>
#include <utility>

#include "app/cancel.h"
#include "app/pipeline.h"
#include "app/scratch_files.h"

namespace becalm::app {

RenderAhead::RenderAhead(RenderedFrames& frames, const NoisyFiles& files,
                         std::vector<filter::Segment> segments, bool keep_files, Progress& progress)
    : frames_(frames),
      files_(files),
      segments_(std::move(segments)),
      keep_files_(keep_files),
      progress_(progress) {
  std::map<int, std::size_t> last_use;
  for (std::size_t segment = 0; segment < segments_.size(); ++segment) {
    for (const filter::Step& step : segments_[segment]) {
      steps_.push_back(step);
      last_use[step.frame] = segment;
    }
    ends_.push_back(steps_.size());
  }
  read_last_in_.resize(segments_.size());
  for (const auto& [frame, segment] : last_use) read_last_in_[segment].push_back(frame);
  tracer_ = std::async(std::launch::async, [this] {
    try {
      trace();
    } catch (...) {
      end();
      throw;
    }
    end();
  });
}

RenderAhead::~RenderAhead() {
  close();
}

void RenderAhead::trace() {
  std::set<int> made;
  for (std::size_t segment = 0; segment < segments_.size(); ++segment) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return closed_ || segment <= reading_ + 2; });
      if (closed_) return;
    }
    std::set<int> needed;
    for (const filter::Step& step : segments_[segment]) needed.insert(step.frame);
    for (const int frame : needed) {
      if (!made.insert(frame).second) continue;
      if (stop_requested() || !frames_.make_file(frame)) return;
    }
    const std::lock_guard lock(mutex_);
    ++made_;
    changed_.notify_all();
  }
}

std::optional<io::LoadedFrame> RenderAhead::next(std::size_t step) {
  while (removed_ < segments_.size() && step + 1 >= ends_[removed_] + kStepsUnderWay && !stop_requested()) {
    remove_files(removed_++);
  }
  {
    std::unique_lock lock(mutex_);
    while (step >= ends_[reading_]) ++reading_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return ended_ || made_ > reading_; });
    if (made_ > reading_) {
      lock.unlock();
      return frames_.read_file(steps_[step].frame);
    }
  }
  tracer_.get();
  return std::nullopt;
}

void RenderAhead::finish(bool all_written) {
  close();
  if (tracer_.valid()) tracer_.get();
  while (removed_ < segments_.size() && (all_written || !stop_requested())) remove_files(removed_++);
}

void RenderAhead::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

void RenderAhead::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void RenderAhead::remove_files(std::size_t segment) const {
  if (keep_files_) return;
  for (const int frame : read_last_in_[segment]) {
    if (const auto warning = remove_scratch_file(files_.outputs.path(frame))) progress_.warn(*warning);
  }
}

}  // namespace becalm::app
