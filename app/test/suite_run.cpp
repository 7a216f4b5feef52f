#include "app/test/suite_run.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

#include "app/cancel.h"
#include "app/test/case_run.h"

namespace becalm::app {
namespace {

CaseResult skipped_case(const TestCase& test, const std::string& why) {
  CaseResult result;
  result.suite = test.suite;
  result.suite_file = test.suite_file;
  result.name = test.name;
  result.messages.push_back(why);
  return result;
}

/// The threads that take one case after the other.
class Workers {
 public:
  Workers(const std::vector<TestCase>& cases, const WorkFolder& folder, const SuiteRunOptions& options,
          const std::function<void(const CaseResult&)>& ended)
      : cases_(cases), folder_(folder), options_(options), ended_(ended), results_(cases.size()) {}

  std::vector<CaseResult> run() {
    {
      std::vector<std::jthread> threads;
      threads.reserve(static_cast<std::size_t>(options_.jobs));
      for (int i = 0; i < options_.jobs; ++i) threads.emplace_back([this] { work(); });
    }
    if (failure_) std::rethrow_exception(failure_);
    return std::move(results_);
  }

 private:
  void work() {
    for (std::size_t i = next_++; i < cases_.size(); i = next_++) {
      try {
        results_[i] = run_one(cases_[i]);
        const std::scoped_lock lock(mutex_);
        ended_(results_[i]);
      } catch (...) {
        const std::scoped_lock lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
        why_stopped_ = "an error ended the run";
      }
    }
  }

  CaseResult run_one(const TestCase& test) {
    if (stop_requested()) return skipped_case(test, "interrupted");
    if (const char* why = why_stopped_) return skipped_case(test, why);
    const RunSettings settings{.work_folder = folder_.folder_of(test),
                               .threads = options_.threads,
                               .reproducible = options_.reproducible};
    CaseResult result = run_case(test, settings).result;
    const bool good = result.outcome == CaseOutcome::passed;
    if (!good && options_.fail_fast) why_stopped_ = "--fail-fast: another case did not pass";
    return result;
  }

  const std::vector<TestCase>& cases_;
  const WorkFolder& folder_;
  const SuiteRunOptions& options_;
  const std::function<void(const CaseResult&)>& ended_;
  std::vector<CaseResult> results_;
  std::atomic<std::size_t> next_{0};
  std::atomic<const char*> why_stopped_{nullptr};  ///< null: every case is run
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

TestResults run_cases(const std::vector<TestCase>& cases, const WorkFolder& folder,
                      const SuiteRunOptions& options, const std::function<void(const CaseResult&)>& ended) {
  const auto start = std::chrono::steady_clock::now();
  TestResults results;
  results.cases = Workers(cases, folder, options, ended).run();
  results.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return results;
}

}  // namespace becalm::app
