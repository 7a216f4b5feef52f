#pragma once

#include <set>
#include <string>
#include <vector>

#include "app/filter_stage.h"
#include "filter/sequence/schedule.h"

namespace becalm::app {

std::set<int> frames_in(const std::vector<filter::Segment>& segments);

/// Which frames are rendered for a filter, and in which order it takes them.
class RenderSchedule {
 public:
  /// `asked` are the frames to write, in ascending order, of a shot that has every `step`-th frame from any
  /// of them on; `first` and `last` are the scene's. `filter` must outlive this.
  RenderSchedule(const FilterStage& filter, const std::vector<int>& asked, int step, int first, int last);

  /// The frames that may be rendered for the filter: those asked for and, if it has segments, those of the
  /// shot and those that --context names.
  const std::vector<int>& readable() const { return readable_; }
  /// What the filter does to output the frames of `work`.
  std::vector<filter::Segment> segments(const std::vector<int>& work) const;
  /// The frames that an output is made from, as its file records them.
  std::string made_from(int frame) const;

 private:
  const FilterStage& filter_;
  std::vector<int> readable_;
  int step_;  ///< largest distance of frame numbers across which history is kept
};

}  // namespace becalm::app
