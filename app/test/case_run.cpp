#include "app/test/case_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "app/test/references.h"
#include "frame/error.h"
#include "frame/io/sequence.h"

namespace becalm::app {
namespace {

namespace fs = std::filesystem;

/// The end of a text file.
std::string tail_of(const std::string& path) {
  constexpr std::streamoff longest = 4000;
  std::ifstream file(path, std::ios::binary);
  file.seekg(0, std::ios::end);
  const std::streamoff size = file.tellg();
  if (!file || size <= 0) return "";
  file.seekg(size > longest ? size - longest : 0);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Fills `run` step by step; each step is the outcome if it is the last.
class CaseRunner {
 public:
  CaseRunner(const TestCase& test, const RunSettings& settings, CaseRun& run)
      : test_(test), settings_(settings), run_(run), result_(run.result) {}

  void run(std::uint32_t seed_offset) {
    if (const std::vector<std::string> missing = missing_references(test_); !missing.empty()) {
      end(CaseOutcome::error,
          fmt::format("no reference {}; make it with --update={}", missing.front(), test_.full_name()));
      return;
    }
    check_references(test_);
    FrameOrder order = order_of_test(test_);
    order.seed += seed_offset;
    order.pattern = settings_.work_folder + "/test/frame.####.exr";
    note_files(order.pattern);
    if (!count(make_frames(test_, order, settings_)) || !denoise(order.pattern)) return;
    judge();
  }

  void end(CaseOutcome outcome, const std::string& message) {
    result_.outcome = outcome;
    result_.messages.push_back(message);
  }

 private:
  void note_files(const std::string& pattern) {
    for (const int number : test_.source.frames) {
      JudgedFrame frame;
      frame.number = number;
      frame.test = io::SequencePattern(pattern).path(number);
      frame.reference = io::SequencePattern(test_.reference_pattern(0)).path(number);
      if (reference_count(test_) > 1) {
        frame.reference_b = io::SequencePattern(test_.reference_pattern(1)).path(number);
      }
      result_.frames.push_back(frame);
    }
  }

  /// Whether the frames were made.
  bool count(const MadeFrames& made) {
    if (result_.command.empty()) result_.command = fmt::format("{}", fmt::join(made.commands, " && "));
    result_.peak_memory_bytes = std::max(result_.peak_memory_bytes, made.peak_memory_bytes);
    run_.interrupted = made.interrupted;
    if (made.interrupted) {
      end(CaseOutcome::skipped, "interrupted");
    } else if (!made.failure.empty()) {
      end(CaseOutcome::failed, made.failure);
    }
    return made.failure.empty();
  }

  bool denoise(const std::string& rendered) {
    if (!test_.judges.denoised) return true;
    const std::string fresh = settings_.work_folder + "/denoised_test/frame.####.exr";
    const std::string reference = settings_.work_folder + "/denoised_reference/frame.####.exr";
    const std::string& preset = test_.judges.denoised->preset;
    for (JudgedFrame& frame : result_.frames) {
      frame.denoised_test = io::SequencePattern(fresh).path(frame.number);
      frame.denoised_reference = io::SequencePattern(reference).path(frame.number);
    }
    return count(denoise_frames(test_, preset, rendered, fresh, settings_)) &&
           count(denoise_frames(test_, preset, test_.reference_pattern(0), reference, settings_));
  }

  void judge() {
    Verdict verdict = judge_frames(test_, result_.frames);
    run_.judged = verdict.problems.empty();
    result_.messages = std::move(verdict.problems);
    result_.checks = std::move(verdict.checks);
    result_.unjudged = std::move(verdict.unjudged);
    run_.measured = std::move(verdict.measured);
    for (const CheckResult& check : result_.checks) {
      if (!check.passed) result_.messages.push_back(fmt::format("{}: {}", check.judge, check.text));
    }
    result_.outcome = result_.messages.empty() ? CaseOutcome::passed : CaseOutcome::failed;
  }

  const TestCase& test_;
  const RunSettings& settings_;
  CaseRun& run_;
  CaseResult& result_;
};

}  // namespace

CaseRun run_case(const TestCase& test, const RunSettings& settings, std::uint32_t seed_offset) {
  const auto start = std::chrono::steady_clock::now();
  CaseRun run;
  run.result.suite = test.suite;
  run.result.suite_file = test.suite_file;
  run.result.name = test.name;
  run.result.layer = test.layer;
  CaseRunner runner(test, settings, run);
  try {
    runner.run(seed_offset);
  } catch (const Error& error) {
    runner.end(CaseOutcome::error, error.what());
  } catch (const std::exception& error) {
    runner.end(CaseOutcome::error, fmt::format("unexpected: {}", error.what()));
  }
  run.result.output = tail_of(output_file(settings));
  run.result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // A frame that was not made has no picture.
  for (JudgedFrame& frame : run.result.frames) {
    for (std::string* file : {&frame.test, &frame.denoised_test, &frame.denoised_reference}) {
      std::error_code ignored;
      if (!file->empty() && !fs::is_regular_file(*file, ignored)) file->clear();
    }
  }
  return run;
}

}  // namespace becalm::app
