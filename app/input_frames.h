#pragma once

#include <set>
#include <string>
#include <vector>

#include "frame/io/sequence.h"

namespace becalm::app {

/// What becomes of a frame that was asked for and is not there.
enum class Missing { error, skip, hold };
Missing parse_missing(const std::string& name);

struct InputFrame {
  int number = 0;
  bool new_history = false;  ///< frames before it are missing, so the filter starts anew
  std::vector<int> outputs;  ///< its own number and, with `hold`, those of the missing frames after it
};

/// Which files of a sequence are read, and for which frames each is written.
class InputFrames {
 public:
  /// `range` empty: all on disk. Throws Error(usage) for a bad range, Error(bad_input) naming the frames that
  /// are not there.
  InputFrames(const std::string& pattern, const std::string& range, Missing missing);

  const std::vector<InputFrame>& frames() const { return frames_; }
  std::string path(int frame) const { return pattern_.path(frame); }
  /// Every frame that is written, ascending.
  std::vector<int> outputs() const;
  /// The first frames, up to the last one of which some output is not among the existing.
  std::vector<InputFrame> up_to_last_missing(const std::set<int>& existing) const;
  /// One line about gaps that nobody asked about, or empty.
  const std::string& note() const { return note_; }

 private:
  void take(const std::vector<int>& asked, const std::vector<int>& present, Missing missing);

  io::SequencePattern pattern_;
  std::vector<InputFrame> frames_;
  std::string note_;
};

}  // namespace becalm::app
