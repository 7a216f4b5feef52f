#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/test/child_process.h"
#include "app/test/suite.h"

namespace becalm::app {

/// One making of a case's frames: those that are judged, or a reference.
struct FrameOrder {
  int spp = 1;
  std::uint32_t seed = 0;
  CommandTemplate command;               ///< empty: the case's scene is rendered
  std::vector<CommandTemplate> prepare;  ///< run before `command`
  std::string preset;                    ///< of the filter; empty: none
  bool variance = false;                 ///< wanted as a layer even if no judge reads it
  std::string pattern;                   ///< where the frames go: an absolute path with ####
};

/// What is judged.
FrameOrder order_of_test(const TestCase& test);
/// The first (0) or the second (1) reference, by the case's "reference". What that leaves open: the source's
/// commands; with `exact` all is as the source has it; otherwise another seed, reference_spp() samples, and
/// no filter.
FrameOrder order_of_reference(const TestCase& test, int which);

/// Throws Error(bad_input) if references are made by the case's own commands and another seed does not change
/// what these are asked.
void require_seed(const TestCase& test);

/// Where and how commands run.
struct RunSettings {
  std::string work_folder;    ///< of one case: an absolute path
  int threads = 1;            ///< for {threads} and becalm's --threads
  bool reproducible = false;  ///< becalm's --reproducible
};

struct MadeFrames {
  std::vector<std::string> commands;  ///< as one would type them; of those that differ by frame, the first
  std::string failure;                ///< why frames are missing, one line; empty if they are all there
  bool interrupted = false;
  std::uint64_t peak_memory_bytes = 0;
};

/// Runs the case's source. What it prints goes to `output.txt` in the work folder. Throws Error(bad_input) if
/// a command cannot be started.
MadeFrames make_frames(const TestCase& test, const FrameOrder& order, const RunSettings& settings);

/// Denoises the frames of a pattern into another, as make_frames runs a source.
MadeFrames denoise_frames(const TestCase& test, const std::string& preset, const std::string& from,
                          const std::string& to, const RunSettings& settings);

/// The file that takes the output of the case's commands.
std::string output_file(const RunSettings& settings);

}  // namespace becalm::app
