#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

// What `becalm test` finds: filled by the runner, read by every report (console, JUnit, JSON, HTML page).

namespace becalm::app {

enum class CaseOutcome {
  passed,
  failed,  ///< the frames are not what they should be, or could not be made
  error,   ///< nothing could be judged: no reference, or a bad one
  skipped  ///< not run: --fail-fast, an interruption, or an error that ended the run
};

/// One comparison and its limit. A limit of every frame is one check; its value is the worst frame's.
struct CheckResult {
  std::string judge;   ///< key of "judged_by": exact, statistical, denoised, perceptual, error, sequence
  std::string figure;  ///< what was measured: relMSE, FLIP, energy ...
  std::optional<int> frame;  ///< of the value; none where it is of the whole sequence
  double value = 0.0;
  double limit = 0.0;
  bool passed = false;
  std::string text;  ///< one line for people: the figure, its value and its limit
};

/// The files of one frame. They are there until the reports are written; `becalm::io::read_exr` reads them,
/// layers of variance included where the case is judged statistically.
struct JudgedFrame {
  int number = 0;
  std::string test;                ///< empty where it was not made
  std::string reference;           ///< empty where there is none
  std::string reference_b;         ///< empty where there is one reference only
  std::string denoised_test;       ///< empty unless judged denoised
  std::string denoised_reference;  ///< the same
};

struct CaseResult {
  std::string suite;       ///< the suite file's name without its ending
  std::string suite_file;  ///< as found from the command line
  std::string name;
  std::string layer;  ///< of the test frames' files that was judged; empty: the beauty, as in references
  CaseOutcome outcome = CaseOutcome::skipped;
  /// Why it is not passed, one line each, the most important first; remarks on a case that passed.
  std::vector<std::string> messages;
  std::vector<CheckResult> checks;
  std::vector<JudgedFrame> frames;
  std::set<int> unjudged;  ///< numbers of frames that could not be judged, which failed the case
  std::string command;     ///< how the frames were made, as one would type it
  std::string output;      ///< the end of what the commands printed
  double seconds = 0.0;
  std::uint64_t peak_memory_bytes = 0;  ///< of the commands; 0 where nothing was run
};

struct TestResults {
  std::vector<CaseResult> cases;  ///< in the order of the suites
  double seconds = 0.0;           ///< from start to end; less than the sum where cases ran side by side
};

inline std::size_t count_of(const TestResults& results, CaseOutcome outcome) {
  std::size_t count = 0;
  for (const CaseResult& result : results.cases) count += result.outcome == outcome ? 1 : 0;
  return count;
}

/// `passed`, `failed`, `error` or `skipped`.
constexpr const char* name_of(CaseOutcome outcome) {
  switch (outcome) {
    case CaseOutcome::passed:
      return "passed";
    case CaseOutcome::failed:
      return "failed";
    case CaseOutcome::error:
      return "error";
    case CaseOutcome::skipped:
      return "skipped";
  }
  return "";
}

}  // namespace becalm::app
