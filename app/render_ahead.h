#pragma once

#include <condition_variable>
#include <cstddef>
#include <future>
#include <mutex>
#include <optional>
#include <vector>

#include "app/rendered_frames.h"
#include "filter/sequence/schedule.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// The source of a filter with segments, which reads frames more than once and in both directions of time:
/// the tracer writes the frames of the next segments to files, in ascending order, while the pipeline reads
/// those of one segment. At most two segments wait between them.
class RenderAhead {
 public:
  /// Starts the tracer, on a thread of its own. `files` are those of `frames`; unless `keep_files`, those
  /// that no segment needs any more are removed.
  RenderAhead(RenderedFrames& frames, const NoisyFiles& files, std::vector<filter::Segment> segments,
              bool keep_files, Progress& progress);
  /// Waits for the frame at work, which a requested stop cuts short.
  ~RenderAhead();
  RenderAhead(const RenderAhead&) = delete;
  RenderAhead& operator=(const RenderAhead&) = delete;

  /// Those of all segments.
  const std::vector<filter::Step>& steps() const { return steps_; }
  /// The noisy frame of a step; nothing if a stop was requested. Throws what ended the tracer.
  std::optional<io::LoadedFrame> next(std::size_t step);
  /// Behind the pipeline: throws what ended the tracer, and removes the last files unless a stop was
  /// requested before all outputs were written.
  void finish(bool all_written);

 private:
  void trace();
  void end();
  void close();
  void remove_files(std::size_t segment) const;

  RenderedFrames& frames_;
  const NoisyFiles& files_;
  const std::vector<filter::Segment> segments_;
  const bool keep_files_;
  Progress& progress_;
  std::vector<filter::Step> steps_;
  std::vector<std::size_t> ends_;               ///< of each segment, the step behind its last one
  std::vector<std::vector<int>> read_last_in_;  ///< of each segment, the frames that no later one reads
  std::size_t removed_ = 0;                     ///< segments whose files are gone
  std::mutex mutex_;                            ///< of what follows
  std::condition_variable changed_;
  std::size_t made_ = 0;     ///< segments whose files are there
  std::size_t reading_ = 0;  ///< the segment that the pipeline reads
  bool ended_ = false;       ///< no further segment will be made
  bool closed_ = false;      ///< no further segment is needed
  std::future<void> tracer_;
};

}  // namespace becalm::app
