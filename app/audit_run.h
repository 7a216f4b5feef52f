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

/// Audits the first, the middle and the last two neighbours of these frames, which ascend, or the only one;
/// each check is told once. Frames come from `read`, two are held at a time.
std::vector<FrameFinding> audit_frames(const std::vector<int>& frames,
                                       const std::function<io::LoadedFrame(int)>& read);

}  // namespace becalm::app
