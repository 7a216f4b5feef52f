// becalm test: suites of cases, each of which makes frames and says how they are judged.

#include <fmt/format.h>
#include <fnmatch.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>

#include "app/cancel.h"
#include "app/command.h"
#include "app/console.h"
#include "app/counted.h"
#include "app/number_checks.h"
#include "app/options.h"
#include "app/outputs.h"
#include "app/report_file.h"
#include "app/test/calibrate.h"
#include "app/test/references.h"
#include "app/test/report_files.h"
#include "app/test/suite.h"
#include "app/test/suite_run.h"
#include "app/test/test_page.h"
#include "app/test/work_folder.h"

namespace becalm::app {
namespace {

struct TestCommand {
  std::vector<std::string> suites;
  std::string filter;
  std::string shard;
  std::string update;  ///< a glob; empty: not asked for
  int calibrate = 0;   ///< seeds; 0: not asked for
  bool yes = false;
  bool list = false;
  bool fail_fast = false;
  bool reproducible = false;
  int jobs = 1;
  int threads = 0;  ///< 0: all processors, shared by the jobs
  std::string keep;
  std::string junit;
  std::string json;
  std::string report;
};

bool matches(const std::string& glob, const TestCase& test) {
  return fnmatch(glob.c_str(), test.name.c_str(), 0) == 0 ||
         fnmatch(glob.c_str(), test.full_name().c_str(), 0) == 0;
}

void keep_matching(const std::string& option, const std::string& glob, std::vector<TestCase>& cases) {
  if (glob.empty()) return;
  const std::size_t count = cases.size();
  std::erase_if(cases, [&](const TestCase& test) { return !matches(glob, test); });
  if (!cases.empty()) return;
  throw Error(ExitStatus::usage, fmt::format("{} {}: matches none of {}; --list tells them", option, glob,
                                             counted(count, "case", "cases")));
}

/// Every Nth case, from the Ith on.
void keep_shard(const std::string& text, std::vector<TestCase>& cases) {
  if (text.empty()) return;
  std::size_t index = 0, count = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, index);
  const bool has_slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = has_slash ? std::from_chars(first.ptr + 1, end, count) : first;
  if (!has_slash || second.ec != std::errc() || second.ptr != end || index < 1 || index > count) {
    throw Error(ExitStatus::usage,
                fmt::format("--shard {}: expected I/N with I from 1 to N, such as 1/4", text));
  }
  std::vector<TestCase> kept;
  for (std::size_t i = index - 1; i < cases.size(); i += count) kept.push_back(std::move(cases[i]));
  cases = std::move(kept);
}

std::string line_of(const CaseResult& result) {
  std::string line = fmt::format("{:<7} {:>7.1f} s  {}/{}", name_of(result.outcome), result.seconds,
                                 result.suite, result.name);
  if (!result.messages.empty()) line += ": " + result.messages.front();
  return line;
}

std::vector<ReportFile> reports_of(const TestCommand& command) {
  std::vector<ReportFile> files;
  if (!command.junit.empty()) files.push_back({"--junit", command.junit, ReportKind::test_junit});
  if (!command.json.empty()) files.push_back({"--json", command.json, ReportKind::test_json});
  if (!command.report.empty()) files.push_back(page_in(command.report, ReportKind::test_page));
  return files;
}

/// One run of `becalm test`.
class TestJob {
 public:
  explicit TestJob(const TestCommand& command) : command_(command), cases_(load_suites(command.suites)) {
    keep_matching("--filter", command.filter, cases_);
    keep_matching("--update", command.update, cases_);
    keep_shard(command.shard, cases_);
  }

  ExitStatus run() {
    if (command_.list) return list();
    if (!command_.update.empty()) return update();
    if (command_.calibrate > 0) return calibrate_cases();
    return test();
  }

 private:
  int threads() const {
    const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    return command_.threads > 0 ? command_.threads : std::max(1, all / command_.jobs);
  }

  ExitStatus list() const {
    for (const TestCase& test : cases_) fmt::print("{}\n", test.full_name());
    return ExitStatus::done;
  }

  ExitStatus test() const {
    const std::vector<ReportFile> reports = reports_of(command_);
    check_report_files(reports, inputs());
    keep_apart_from_suites(reports);
    const WorkFolder folder(command_.keep, cases_);
    std::FILE* const lines = stream_beside(reports);
    const TestResults results =
        run_cases(cases_, folder, {command_.jobs, threads(), command_.fail_fast, command_.reproducible},
                  [lines](const CaseResult& result) {
                    fmt::print(lines, "{}\n", line_of(result));
                    std::fflush(lines);
                  });
    const std::size_t failed = count_of(results, CaseOutcome::failed);
    const std::size_t errors = count_of(results, CaseOutcome::error);
    fmt::print(lines, "{} passed, {} failed, {}, {} skipped in {:.1f} s\n",
               count_of(results, CaseOutcome::passed), failed, counted(errors, "error", "errors"),
               count_of(results, CaseOutcome::skipped), results.seconds);
    write_report_files(reports, [&](ReportKind kind) { return report_text(kind, results); });
    if (interrupted()) return ExitStatus::interrupted;
    return errors > 0 ? ExitStatus::bad_input : failed > 0 ? ExitStatus::comparison_failed : ExitStatus::done;
  }

  /// A report among the suites of a folder would be read as one of them by the next run.
  void keep_apart_from_suites(const std::vector<ReportFile>& reports) const {
    for (const ReportFile& report : reports) {
      const std::filesystem::path path = resolved(report.path);
      for (const std::string& suites : command_.suites) {
        if (path.extension() != ".json" || path.parent_path() != resolved(suites)) continue;
        throw Error(
            ExitStatus::usage,
            fmt::format("{} {}: would be read as a suite, as every .json file in {}; choose another folder",
                        report.option, report.path, suites));
      }
    }
  }

  static std::string report_text(ReportKind kind, const TestResults& results) {
    if (kind == ReportKind::test_junit) return junit_xml(results);
    return kind == ReportKind::test_json ? results_json(results) : test_page(results);
  }

  /// Suites, scenes and references, also those that are not there yet.
  std::vector<std::string> inputs() const {
    std::vector<std::string> files;
    for (const TestCase& test : cases_) {
      files.push_back(test.suite_file);
      if (!test.source.scene.empty()) files.push_back(test.source.scene);
      std::ranges::move(reference_files(test), std::back_inserter(files));
    }
    return files;
  }

  ExitStatus calibrate_cases() const {
    const WorkFolder folder(command_.keep, cases_);
    for (const TestCase& test : cases_) {
      for (const std::string& line :
           calibrate(test, command_.calibrate, folder, threads(), command_.reproducible)) {
        fmt::print("{}\n", line);
      }
      std::fflush(stdout);
    }
    return ExitStatus::done;
  }

  ExitStatus update() const {
    if (!command_.yes && isatty(STDIN_FILENO) == 0) {
      throw Error(ExitStatus::usage,
                  "--update replaces references and asks first, and standard input is no terminal; --yes "
                  "answers");
    }
    const WorkFolder folder(command_.keep, cases_);
    UpdateCounts counts;
    for (const TestCase& test : cases_) {
      try {
        update_case(test, folder, counts);
      } catch (const Error& error) {
        if (error.status() != ExitStatus::bad_input) throw;  // what ends every other case, too
        say_error(error.status(), error.what());
        ++counts.failed;
      }
    }
    const bool all_is_said = cases_.size() == 1 && counts.failed == 1;
    if (!all_is_said) print_counts(counts);
    return counts.failed > 0 ? ExitStatus::bad_input : ExitStatus::done;
  }

  /// Cases of --update, and the size of the new references.
  struct UpdateCounts {
    std::size_t updated = 0;
    std::size_t declined = 0;
    std::size_t failed = 0;
    std::uint64_t bytes = 0;
  };

  static void print_counts(const UpdateCounts& counts) {
    fmt::print("{:.1f} KiB of references in {}{}{}\n", static_cast<double>(counts.bytes) / 1024.0,
               counted(counts.updated, "case", "cases"),
               counts.declined > 0 ? fmt::format(", {} left as before", counts.declined) : "",
               counts.failed > 0 ? fmt::format(", {} failed", counts.failed) : "");
  }

  void update_case(const TestCase& test, const WorkFolder& folder, UpdateCounts& counts) const {
    const RunSettings settings{
        .work_folder = folder.folder_of(test), .threads = threads(), .reproducible = command_.reproducible};
    ReferenceUpdate update(test, settings);
    update.make();
    for (const std::string& change : update.changes()) fmt::print("{}\n", change);
    std::fflush(stdout);
    if (!command_.yes && !asked(test, "Keep the new references?")) {
      ++counts.declined;
      return;
    }
    update.accept();
    ++counts.updated;
    counts.bytes += update.bytes();
  }

  /// Throws Error(interrupted) if a signal comes instead of the answer.
  static bool asked(const TestCase& test, const std::string& question) {
    fmt::print(stderr, "{} [y/N] ", question);
    constexpr int wait_ms = 100;  // a signal may come just before the wait, and would not end it
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    while (std::cin.good() && poll(&input, 1, wait_ms) <= 0) {
      if (!interrupted()) continue;
      fmt::print(stderr, "\n");
      throw Error(ExitStatus::interrupted,
                  fmt::format("{}: interrupted; its references are as before", test.full_name()));
    }
    std::string answer;
    std::getline(std::cin, answer);
    return answer == "y" || answer == "yes";
  }

  const TestCommand& command_;
  std::vector<TestCase> cases_;
};

void add_test_options(CLI::App& parser, TestCommand& command) {
  constexpr const char* suites = "SUITE.json|DIR...";
  parser.add_option(suites, command.suites, "Suite files, or folders of them")
      ->required()
      ->take_all()
      ->option_text(suites);
  parser.add_option("--filter", command.filter, "Only cases whose name, or SUITE/NAME, matches")
      ->option_text("GLOB")
      ->group("Cases");
  parser.add_option("--shard", command.shard, "Every Nth case from the Ith on, for N machines")
      ->option_text("I/N")
      ->group("Cases");
  parser.add_flag("--list", command.list, "Print the names of the cases, and run none")->group("Cases");
  parser
      .add_flag("--fail-fast", command.fail_fast, "Skip the others after the first case that does not pass")
      ->group("Cases");
  parser
      .add_flag(
          "--update{*}", command.update,
          "Make the references of the cases that match (default: all) anew, print what changes, and ask")
      ->option_text("[=GLOB]")
      ->group("References");
  parser
      .add_flag("-y,--yes", command.yes, "Answer that with yes; needed where standard input is no terminal")
      ->group("References");
  parser
      .add_flag("--calibrate{16}", command.calibrate,
                "Run each case with so many seeds (default: 16) and propose limits for its false-alarm rate")
      ->check(whole_number_from(3, 10000))
      ->option_text("[=N]")
      ->group("References");
  parser.add_option("--junit", command.junit, "Write JUnit's XML, for CI systems, over that of the last run")
      ->option_text("FILE")
      ->group("Reports");
  parser
      .add_option("--json", command.json,
                  "Write all figures, over those of the last run; - is standard output")
      ->option_text("FILE")
      ->group("Reports");
  parser
      .add_option("--report", command.report,
                  "Write a page with pictures of the cases that did not pass, index.html in this folder")
      ->option_text("DIR")
      ->group("Reports");
  parser.add_option("--keep", command.keep, "Keep the cases' frames and output in this folder")
      ->option_text("DIR")
      ->group("Reports");
  parser.add_option("--jobs", command.jobs, "Cases that run side by side (default: 1)")
      ->check(whole_number_from(1, 1024))
      ->option_text("N")
      ->group("Running");
  parser
      .add_option("--threads", command.threads,
                  "Processor threads of each case (default: all, shared by the jobs)")
      ->check(whole_number_from(1, 4096))
      ->option_text("N")
      ->group("Running");
  parser
      .add_flag(
          "--reproducible", command.reproducible,
          "Pass --reproducible to becalm render and denoise (not to commands), so that exact holds on other "
          "x86-64 processors; use it with --update too")
      ->group("Running");
}

/// Only a run of the cases has what reports tell.
void exclude_what_would_be_ignored(CLI::App& parser) {
  CLI::Option* list = parser.get_option("--list");
  CLI::Option* update = parser.get_option("--update");
  CLI::Option* calibrate = parser.get_option("--calibrate");
  update->excludes(calibrate, list);
  calibrate->excludes(list);
  for (const char* report : {"--junit", "--json", "--report"}) {
    parser.get_option(report)->excludes(list, update, calibrate);
  }
  for (const char* option : {"--jobs", "--fail-fast"}) parser.get_option(option)->excludes(update, calibrate);
}

}  // namespace

Command add_test(CLI::App& becalm) {
  CLI::App& parser = *becalm.add_subcommand("test", "Run the regression suites of a renderer");
  auto command = std::make_shared<TestCommand>();
  add_test_options(parser, *command);
  exclude_what_would_be_ignored(parser);
  parser.footer(
      "Examples:\n"
      "  becalm test tests/regression --jobs 2 --junit results.xml\n"
      "  becalm test suite.json --filter 'glass*' --keep out\n"
      "  becalm test suite.json --update=glass --yes\n"
      "tests/regression/FORMAT.md has the format of suites.\n");
  return {&parser, [command] {
            catch_signals();
            empty_earlier(reports_of(*command));
            return TestJob(*command).run();
          }};
}

}  // namespace becalm::app
