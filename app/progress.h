#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace becalm::app {

struct ProgressOptions {
  std::size_t total = 0;        ///< frames asked for
  std::size_t existing = 0;     ///< of them, those whose files are there already
  std::size_t work = 0;         ///< frames to go through, written or not; with `steps`, those to be made
  std::size_t steps = 0;        ///< of a filter that works on these frames beside what makes them; 0: none
  std::string unit = "frames";  ///< what the rate counts: "samples" or "frames"
  double units_per_frame = 1.0;
  bool quiet = false;    ///< warnings only
  bool verbose = false;  ///< details, too
  /// Where no terminal shows a moving line: how long a command is silent before the next step of its work
  /// (some samples, one frame through the filter) is told. Farms take a long silence for a process that
  /// hangs.
  std::chrono::milliseconds say_every = std::chrono::seconds(30);
};

/// Progress on standard error: frames done, time left and a rate, as one moving line on a terminal, and
/// elsewhere as one line a frame and one in between every ProgressOptions::say_every; or as JSON, whose
/// events are `frame`, `progress` (at most one a second), `message` and `end`. May be called from any thread.
class Progress {
 public:
  explicit Progress(const ProgressOptions& options);
  /// Takes the moving line away.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `frame` is being worked on; `frames_done` frames of the work are done, parts of a frame included.
  void update(int frame, double frames_done);
  /// The filter beside it works on `frame` and has done so many of its steps.
  void update_filter(int frame, std::size_t steps_done);
  /// The frame was worked on but its file exists already and is not written again.
  void frame_kept(int frame);
  void frame_written(int frame);
  /// A line that --quiet does not silence.
  void warn(std::string_view line);
  /// A line of information, which --quiet silences.
  void note(std::string_view line);
  /// A line that is printed with --verbose only.
  void detail(std::string_view line);
  /// Takes the moving line away; if all is `done`, prints the closing line: frames, time, rate.
  void finish(bool done);

  /// Files that are there: the existing ones and those of this run.
  std::size_t written() const;

 private:
  using Clock = std::chrono::steady_clock;

  double elapsed_s() const;
  std::string rate() const;
  double share_done() const;
  double seconds_left() const;
  std::string time_left() const;
  void tell_work(int frame);
  void frame_done(int frame, std::string_view state);
  void say_figures(int frame, std::string_view state);
  /// How far it is and how long it takes, for JSON.
  nlohmann::ordered_json figures() const;
  void draw();
  void erase();

  const ProgressOptions options_;
  const bool terminal_;
  const Clock::time_point start_ = Clock::now();
  mutable std::mutex mutex_;
  Clock::time_point drawn_{};
  Clock::time_point said_ = start_;  ///< a line of a frame, where there is no terminal
  std::size_t written_ = 0;          ///< by this run
  std::size_t worked_ = 0;           ///< by this run, written or kept
  int frame_ = 0;
  double frames_done_ = 0.0;
  double made_s_ = 0.0;           ///< when all of the work was done; 0: not yet
  std::size_t steps_done_ = 0;    ///< by the filter
  double filter_begins_s_ = 0.0;  ///< when its first step began
  bool line_shown_ = false;
};

/// `0:42`, `12:05`, `3:01:07`.
std::string format_duration(double seconds);

}  // namespace becalm::app
