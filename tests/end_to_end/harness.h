#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "frame/aov.h"
#include "frame/frame.h"
#include "frame/io/exr.h"

namespace becalm::test {

namespace fs = std::filesystem;

/// Exit statuses.
inline constexpr int kUsage = 2;
inline constexpr int kBadInput = 3;
inline constexpr int kResource = 4;

/// A folder of its own for one test, gone with it.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const fs::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

struct Outcome {
  int status = -1;  ///< the exit status; 128 + the signal where one ended it
  std::string out;
  std::string err;
  std::string command;  ///< as one would type it
};

/// The real executable at work; with a script, bash runs that instead, in which `"$0" "$@"` is becalm and its
/// arguments.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments, const std::string& shell_script = "");
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  /// What it wrote to standard error so far.
  std::string err() const;
  /// Waits until standard error has `text`, for a minute at most.
  bool wait_for(const std::string& text) const;
  /// Waits up to a minute.
  Outcome wait();

 private:
  TempFolder streams_;
  pid_t process_ = -1;
  std::string command_;
};

/// Runs `becalm ARGUMENTS...` to its end.
Outcome becalm(const std::vector<std::string>& arguments);
/// The same with its streams redirected as bash does it, such as `2>/dev/full`.
Outcome becalm_redirected(const std::vector<std::string>& arguments, const std::string& redirection);
/// Runs `becalm ARGUMENTS...`, expecting status 0.
Outcome becalm_done(const std::vector<std::string>& arguments);

/// Whether an option is among the arguments, so that a test's own default would be its second value.
bool has_option(const std::vector<std::string>& arguments, const std::string& name);

/// Waits until `condition` holds, for a minute at most.
bool wait_until(const std::function<bool()>& condition);

void write_text(const std::string& path, const std::string& text);
/// A floor and a ball that rolls, under a lamp; 48x32 pixels, frames 1 to 4.
std::string write_scene(const TempFolder& folder);
/// Colour noise of that size, the same for the same arguments, with albedo and normal.
Frame noise_frame(int number, int width = 48, int height = 32);

/// Layers that are each a share of the frame's beauty: `A.` for channels `A.R`, `A.G` and `A.B`.
void write_shares(const std::string& path, const Frame& frame, const std::map<std::string, float>& shares,
                  const std::vector<std::string>& views = {});

Frame read_frame(const std::string& path, AovSet aovs = {});
/// All AOVs that the tracer makes, for read_frame.
AovSet all_aovs();
std::vector<std::string> files_in(const fs::path& folder);
std::string frame_path(const std::string& pattern, int frame);

/// Bit for bit, NaN included.
bool same_pixels(const Image& a, const Image& b);
/// The beauties of frames first to last of two patterns.
void expect_same_beauty(const std::string& pattern_a, const std::string& pattern_b, int first, int last);
/// One line on standard error, `becalm: error: ...`, with all of `words`; and the status.
void expect_error(const Outcome& outcome, int status, const std::vector<std::string>& words);

}  // namespace becalm::test
