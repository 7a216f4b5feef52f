#pragma once

#include <functional>
#include <string>
#include <vector>

#include "frame/audit/audit.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// What an audit found, and the frame where it did first.
struct FrameFinding {
  int frame = 0;
  std::string view;  ///< empty where there is but one
  audit::Finding finding;

  /// `frame 12: SENTENCE (check)`.
  std::string text() const;
};

/// Audits three pairs of frames that are one step apart, among these, which ascend: the first, the middle and
/// the last; or the first frame where there is no such pair. A check that finds something is reported once.
/// `read` gives a frame; two are held at a time.
std::vector<FrameFinding> audit_frames(const std::vector<int>& frames,
                                       const std::function<io::LoadedFrame(int)>& read);

}  // namespace becalm::app
