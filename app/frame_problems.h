#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frame/io/sequence.h"

namespace becalm::app {

/// What is wrong with frames of a sequence, collected so that a user reads all of it at once.
class FrameProblems {
 public:
  /// The shot has every `step`-th frame.
  FrameProblems(const io::SequencePattern& pattern, int step) : pattern_(pattern), step_(step) {}

  /// A file's path at the front of `problem` is left out, so that frames with one problem share a line.
  void add(int frame, std::string problem);
  bool empty() const { return problems_.empty(); }
  /// Throws Error(bad_input). The message of a single problem is the problem with its frames. Several
  /// problems are first printed on standard error, a line each; the message is then how many of `total`
  /// frames have one, and `consequence`.
  [[noreturn]] void fail(std::size_t total, std::string_view consequence) const;

 private:
  std::string frames_text(const std::vector<int>& frames) const;

  const io::SequencePattern& pattern_;
  int step_;
  std::vector<std::pair<std::string, std::vector<int>>> problems_;  ///< in the order of their first frames
};

}  // namespace becalm::app
