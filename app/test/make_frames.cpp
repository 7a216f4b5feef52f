#include "app/test/make_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <set>

#include "app/test/shell_words.h"
#include "frame/aov.h"
#include "frame/error.h"
#include "frame/io/frame_range.h"
#include "frame/io/printable.h"
#include "frame/io/sequence.h"

namespace becalm::app {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

/// Far from the seeds that a case's own frames and --calibrate take.
constexpr std::uint32_t kReferenceSeeds = 1000000;

std::string becalm_executable() {
  return fs::read_symlink("/proc/self/exe").string();
}

/// The layers that the judges read, and those that the source names.
std::string asked_aovs(const TestCase& test, const FrameOrder& order) {
  std::set<std::string> aovs(test.source.aovs.begin(), test.source.aovs.end());
  if (test.judges.statistical || order.variance) aovs.insert("variance");
  if (find_aov(test.layer) && test.layer != "beauty") aovs.insert(test.layer);
  if (test.judges.denoised) aovs.insert({"albedo", "normal", "depth", "variance"});
  return fmt::format("{}", fmt::join(aovs, ","));
}

Arguments render_command(const TestCase& test, const FrameOrder& order, const RunSettings& settings) {
  const CaseSource& source = test.source;
  Arguments command{becalm_executable(),
                    "render",
                    source.scene,
                    "-o",
                    order.pattern,
                    "--frames=" + io::format_frame_range(source.frames),
                    "--spp",
                    std::to_string(order.spp),
                    "--seed",
                    std::to_string(order.seed),
                    "--threads",
                    std::to_string(settings.threads),
                    "--quiet"};
  if (settings.reproducible) command.emplace_back("--reproducible");
  if (test.judges.statistical)
    command.emplace_back("--type=float");  // half rounds dark pixels by more than noise
  if (!source.size.empty()) command.insert(command.end(), {"--size", source.size});
  if (const std::string aovs = asked_aovs(test, order); !aovs.empty()) {
    command.insert(command.end(), {"--aovs", aovs});
  }
  // The case's frames are all there is: the filter would have others rendered for it.
  if (!order.preset.empty())
    command.insert(command.end(), {"--denoise=" + order.preset, "--context", "none"});
  return command;
}

/// {work}: what is prepared for one making of the frames lies beside them.
std::string work_of(const FrameOrder& order) {
  return (fs::path(order.pattern).parent_path() / "work").string();
}

/// One command, or the same for each of several frames.
using Step = std::vector<Arguments>;

/// A command with {frame} runs once a frame; another makes all frames of a pattern, or the only one.
Step step_of(const CommandTemplate& command, const TestCase& test, const FrameOrder& order,
             const RunSettings& settings) {
  const io::SequencePattern pattern(order.pattern);
  const std::vector<int>& frames = test.source.frames;
  const auto for_frame = [&](int frame, const std::string& output) {
    return substituted(command, {{"{frame}", std::to_string(frame)},
                                 {"{spp}", std::to_string(order.spp)},
                                 {"{seed}", std::to_string(order.seed)},
                                 {"{threads}", std::to_string(settings.threads)},
                                 {"{becalm}", becalm_executable()},
                                 {"{work}", work_of(order)},
                                 {"{output}", output}});
  };
  if (!has_placeholder(command, "{frame}")) {
    return {for_frame(frames.front(), frames.size() == 1 ? pattern.path(frames[0]) : order.pattern)};
  }
  Step step;
  for (const int frame : frames) step.push_back(for_frame(frame, pattern.path(frame)));
  return step;
}

std::vector<Step> steps_of(const TestCase& test, const FrameOrder& order, const RunSettings& settings) {
  if (order.command.empty()) return {{render_command(test, order, settings)}};
  std::vector<Step> steps;
  for (const CommandTemplate& command : order.prepare)
    steps.push_back(step_of(command, test, order, settings));
  steps.push_back(step_of(order.command, test, order, settings));
  return steps;
}

/// Behind how a command ended: the last line that it printed, safe for a terminal.
std::string last_line(const std::string& file) {
  std::ifstream stream(file);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    const std::size_t end = line.find_last_not_of(" \t\r");
    if (end != std::string::npos) last = line.substr(0, end + 1);
  }
  constexpr std::size_t longest = 300;
  return last.empty() ? "" : ": " + io::printable(last, longest);
}

MadeFrames run_all(const TestCase& test, const std::vector<Step>& steps, const std::string& working_folder,
                   const std::string& pattern, const RunSettings& settings) {
  MadeFrames made;
  ChildLimits limits{.timeout_s = test.source.timeout_s, .memory_bytes = test.source.memory_bytes};
  for (const Step& step : steps) {
    made.commands.push_back(shell_line(step.front()));
    for (const Arguments& command : step) {
      const ChildResult result = run_child(command, working_folder, output_file(settings), limits);
      made.peak_memory_bytes = std::max(made.peak_memory_bytes, result.peak_memory_bytes);
      made.interrupted = result.end == ChildEnd::interrupted;
      if (result.succeeded()) continue;
      made.failure = fmt::format("{} {}{}", fs::path(command.front()).filename().string(),
                                 describe(result, limits), last_line(output_file(settings)));
      return made;
    }
  }
  for (const int frame : test.source.frames) {
    const std::string path = io::SequencePattern(pattern).path(frame);
    if (fs::is_regular_file(path)) continue;
    made.failure = fmt::format("frame {} was not written{}", frame, last_line(output_file(settings)));
    break;
  }
  return made;
}

}  // namespace

FrameOrder order_of_test(const TestCase& test) {
  return {.spp = test.source.spp,
          .seed = test.source.seed,
          .command = test.source.command,
          .prepare = test.source.prepare,
          .preset = test.source.preset,
          .pattern = {}};
}

FrameOrder order_of_reference(const TestCase& test, int which) {
  const bool exact = test.judges.exact.has_value();
  const CaseSource& source = test.source;
  const bool is_other = !test.reference.command.empty();
  const std::uint32_t seed = exact ? source.seed : source.seed + kReferenceSeeds;
  return {.spp = reference_spp(test),
          .seed = test.reference.seed.value_or(seed) + static_cast<std::uint32_t>(which),
          .command = is_other ? test.reference.command : source.command,
          .prepare = is_other ? std::vector<CommandTemplate>{} : source.prepare,
          .preset = test.reference.preset.value_or(exact ? source.preset : ""),
          .variance = !exact,  // for the rounding of what is stored
          .pattern = {}};
}

void require_seed(const TestCase& test) {
  const CaseSource& source = test.source;
  if (source.command.empty() || !test.reference.command.empty() ||
      any_has_placeholder(source.command, source.prepare, "{seed}")) {
    return;
  }
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: /cases/{}/source/command: expected {{seed}} in one of the arguments; without "
                          "it, frames of another seed would have the same noise",
                          test.suite_file, test.name));
}

MadeFrames make_frames(const TestCase& test, const FrameOrder& order, const RunSettings& settings) {
  fs::create_directories(order.command.empty() ? fs::path(order.pattern).parent_path().string()
                                               : work_of(order));
  // Words of a command may be paths, which are from the suite file as all paths in it.
  const fs::path suite_folder = fs::absolute(test.suite_file).parent_path();
  const fs::path folder = order.command.empty() ? fs::current_path() : suite_folder;
  return run_all(test, steps_of(test, order, settings), folder.string(), order.pattern, settings);
}

MadeFrames denoise_frames(const TestCase& test, const std::string& preset, const std::string& from,
                          const std::string& to, const RunSettings& settings) {
  Arguments command{becalm_executable(),
                    "denoise",
                    from,
                    "-o",
                    to,
                    "--frames=" + io::format_frame_range(test.source.frames),
                    "--context",
                    "none",  // the other side may lack frames beyond the case's
                    "--preset",
                    preset,
                    "--threads",
                    std::to_string(settings.threads),
                    "--quiet"};
  if (settings.reproducible) command.emplace_back("--reproducible");
  return run_all(test, {{command}}, fs::current_path().string(), to, settings);
}

std::string output_file(const RunSettings& settings) {
  return settings.work_folder + "/output.txt";
}

}  // namespace becalm::app
