#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/frame_figures.h"
#include "app/test/command_template.h"

namespace becalm::app {

/// What makes the frames of a case: a scene that becalm renders, or a command.
struct CaseSource {
  std::string scene;                     ///< relative paths are from the current folder; empty for a command
  CommandTemplate command;               ///< writes the frames; empty for a scene
  std::vector<CommandTemplate> prepare;  ///< run before `command`, which reads what they write
  std::vector<int> frames{1};
  int spp = 16;
  std::uint32_t seed = 1;
  std::string size;               ///< WxH; empty: the scene's
  std::vector<std::string> aovs;  ///< besides those that a judge needs
  std::string preset;             ///< of `render --denoise`; empty: not denoised
  double timeout_s = 600.0;
  std::uint64_t memory_bytes = 0;  ///< 0: no limit
};

/// How references are made by --update; what is not given follows from the source and the judges.
struct ReferenceSettings {
  std::optional<int> spp;
  std::optional<std::uint32_t> seed;
  std::optional<int> count;           ///< 1, or 2 independent ones
  std::optional<std::string> preset;  ///< empty: not denoised
  CommandTemplate command;            ///< instead of the source; empty: the source makes them
};

/// One limit of a frame's figure.
struct FigureLimit {
  const Figure* figure;
  std::string judge;  ///< perceptual, error or denoised
  std::string key;    ///< as the suite spells it
  double limit;
};

/// Pixels are equal, or at most so many representable numbers apart.
struct ExactJudge {
  int max_ulps = 0;
};

/// Limits after both sides were denoised with one preset.
struct DenoisedJudge {
  std::string preset = "balanced";
  std::vector<FigureLimit> limits;
};

/// Limits of a whole sequence.
struct SequenceJudge {
  std::optional<double> max_temporal_error;  ///< mean over all pairs of frames
  std::optional<double> max_flicker;
};

struct Judges {
  std::optional<ExactJudge> exact;
  bool statistical = false;  ///< a test of hypothesis: the expectation is the reference's
  std::optional<DenoisedJudge> denoised;
  std::vector<FigureLimit> limits;  ///< perceptual and error
  std::optional<SequenceJudge> sequence;

  bool empty() const { return !exact && !statistical && !denoised && limits.empty() && !sequence; }
};

struct TestCase {
  std::string suite;             ///< its file's name without the ending; see load_suites
  std::string suite_file;        ///< as the user named it, or below the folder that the user named
  std::string name;              ///< letters, digits and . _ -
  std::string reference_folder;  ///< references/NAME beside the suite file
  CaseSource source;
  std::string layer;  ///< that is judged; empty: the beauty
  ReferenceSettings reference;
  Judges judges;
  /// Probability that `statistical` fails although nothing is wrong, and for which --calibrate proposes
  /// limits.
  double false_alarm_rate = 0.001;

  /// SUITE/NAME, which --filter matches as well as NAME.
  std::string full_name() const { return suite + "/" + name; }
  /// Files of the first (0) or the second (1) reference.
  std::string reference_pattern(int which) const {
    return reference_folder + (which == 0 ? "/a.####.exr" : "/b.####.exr");
  }
};

/// References of each frame.
int reference_count(const TestCase& test);

/// Samples per pixel of each reference: what the case says; else those of the source if the case is judged
/// `exact`, or `denoised`, whose filter would otherwise see two noise levels, or if the references' command
/// has no {spp}; else 16 times those, tracer::kMostSamples at most.
int reference_spp(const TestCase& test);

/// The cases of suite files, or of all `*.json` of a folder, in the order of files and names. Suites of one
/// file name are told apart by their folders: `glass.suite` and `metal.suite`. Throws Error(bad_input), one
/// line `FILE: /json/pointer: message`.
std::vector<TestCase> load_suites(const std::vector<std::string>& paths);

}  // namespace becalm::app
