#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "frame/io/sequence.h"

namespace becalm::app {

/// What becomes of a frame that was asked for and is not there.
enum class Missing { error, skip, hold };
Missing parse_missing(const std::string& name);

/// The smallest distance between frame numbers, which ascend: 2 for a sequence on twos. At least 1.
int usual_step(const std::vector<int>& frames);

/// Which files of a sequence are read, and for which frames each is written.
class InputFrames {
 public:
  /// Chooses the frames that may be read from those asked for and those on disk.
  using Readable =
      std::function<std::vector<int>(const std::vector<int>& asked, const std::vector<int>& on_disk)>;

  /// `patterns` are two sequences that hold a half of the samples each, or as `pair` says the left and the
  /// right eye; or one, whose other half is found unless `pair` is none. `range` empty: all on disk.
  /// `frame` is the number of a single file, whatever its name says. Throws Error(usage) for a bad range, a
  /// number for a sequence, or a sequence beside a single file, Error(bad_input) naming the frames that are
  /// not there.
  enum class Pair { none, halves, eyes };
  InputFrames(const std::vector<std::string>& patterns, Pair pair, const std::string& range,
              std::optional<int> frame, Missing missing, const Readable& readable);

  const io::SequencePattern& pattern() const { return pattern_; }
  /// Of a pair of sequences, the other half of the samples: given as one, or found beside the first.
  const std::optional<io::SequencePattern>& other_half() const { return other_half_; }
  /// Of a pair of sequences, the right eye, where pattern() is the left one.
  const std::optional<io::SequencePattern>& other_eye() const { return other_eye_; }
  /// The files of a frame: one, or two halves or eyes.
  std::vector<std::string> paths(int frame) const;
  /// What may be read, ascending.
  const std::vector<int>& readable() const { return readable_; }
  std::string path(int frame) const { return pattern_.path(frame); }
  /// A pattern of outputs, in which a lone `#` has the padding of the input's numbers.
  io::SequencePattern output_pattern(const std::string& text) const;
  /// False for a single file that has no number, neither in its name nor by --frame: it is frame 1.
  bool has_numbers() const { return has_numbers_; }
  /// The usual distance between the numbers of frames that may be read.
  int step() const { return step_; }
  /// Every frame that is written, ascending.
  std::vector<int> outputs() const;
  /// Every frame that some output is made of, ascending.
  std::vector<int> sources() const;
  /// For which frames a frame is written: its own number if that was asked for and, with `hold`, those of the
  /// missing frames after it.
  const std::vector<int>& outputs_of(int frame) const { return outputs_.at(frame); }
  /// Frames that have an output which is not among the existing ones.
  std::set<int> sources_of_missing(const std::set<int>& existing) const;
  /// Frames that have outputs, up to the last one that has an output which is not among the existing ones.
  std::set<int> up_to_last_missing(const std::set<int>& existing) const;
  /// Lines about frames that are damaged or missing, and about gaps where --frames did not say which to use.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  /// Throws Error(usage) for two patterns that cannot be a pair.
  static void refuse_no_pair(const std::string& first, const std::string& second, Pair pair);
  void take_other(const std::string& other_pattern, Pair pair);
  void take_single_file(const std::string& range, std::optional<int> frame);
  /// The other sequence of a pair.
  const std::optional<io::SequencePattern>& other() const { return other_eye_ ? other_eye_ : other_half_; }
  std::vector<const io::SequencePattern*> sequences() const;
  /// Their patterns, for messages.
  std::string names() const;
  /// Throws Error(bad_input) for a frame of `asked` (of all if there are none) that one of a pair lacks.
  void refuse_incomplete(const std::vector<int>& asked) const;
  bool leave_damaged(std::vector<int>& present);
  void note_absent(const std::vector<int>& asked, const std::vector<int>& complete, Missing missing);
  void assign_outputs(const std::vector<int>& asked, const std::vector<int>& present, Missing missing);

  io::SequencePattern pattern_;
  std::optional<io::SequencePattern> other_half_;
  std::optional<io::SequencePattern> other_eye_;
  int padding_ = 0;  ///< of the numbers in the files' names; 0: no number there
  bool has_numbers_ = true;
  std::vector<int> readable_;
  int step_ = 1;
  std::map<int, std::vector<int>> outputs_;  ///< by the frame that is read
  std::vector<std::string> notes_;
};

}  // namespace becalm::app
