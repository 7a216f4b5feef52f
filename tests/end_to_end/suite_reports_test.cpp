// becalm test: where reports and kept frames may go, which is known before the first case runs.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/end_to_end/suite_fixture.h"

namespace becalm::test {
namespace {

class SuiteReports : public SuiteTest {
 protected:
  SuiteReports() {
    write_suite(shell_case("good", "cp image.exr $0; touch ran") + ", " + kScene);
    write_reference("good");
  }
  /// Refused before a case runs; every file of the folder stays as it is.
  void expect_refused(const std::vector<std::string>& options, int status,
                      const std::vector<std::string>& words) const {
    const std::vector<std::string> before = texts();
    const Outcome outcome = run(options);
    expect_error(outcome, status, words);
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(fs::exists(folder_ / "ran"));
    EXPECT_EQ(texts(), before);
  }
  /// Names and contents of all files of the folder.
  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_.path())) {
      if (entry.is_regular_file())
        all.push_back(entry.path().string() + ": " + read_text(entry.path().string()));
    }
    std::ranges::sort(all);
    return all;
  }

  static constexpr const char* kScene =
      R"("scene": {"source": {"scene": "scene.json"}, "judged_by": {"exact": true}})";
};

TEST_F(SuiteReports, OnStandardOutputAreAloneThere) {
  const Outcome outcome = run({"--json", "-", "--filter", "good"});
  EXPECT_TRUE(nlohmann::json::parse(outcome.out).contains("cases")) << outcome.out;
  EXPECT_NE(outcome.err.find("1 passed"), std::string::npos) << outcome.err;
  expect_error(run({"--json", "-", "--junit", "-"}), 2, {"is another report's, too"});
}

TEST_F(SuiteReports, ReplaceNoInput) {
  const std::string input = "would overwrite the input";
  expect_refused({"--junit", suite_}, 2, {"--junit", suite_, input});
  fs::create_symlink(suite_, folder_ / "link.json");
  expect_refused({"--json", folder_ / "link.json"}, 2, {"--json", "link.json", input});
  expect_refused({"--json", folder_ / "references/good/a.0001.exr"}, 2, {"--json", "a.0001.exr", input});
  expect_refused({"--json", folder_ / "scene.json"}, 2, {"--json", "scene.json", input});
  expect_refused({"--json", folder_ / "references/scene/a.0001.exr"}, 2,
                 {"--json", "references/scene/a.0001.exr", input});
}

TEST_F(SuiteReports, ReplaceNothingForeign) {
  const std::string own = folder_ / "own";
  for (const char* text : {"text", "{\"cases\": []}", "<testsuites name=\"other\"/>", "[1"}) {
    write_text(own, text);
    expect_refused({"--json", own}, 2, {"--json", own, "is no JSON report of becalm test"});
    expect_refused({"--junit", own}, 2, {"--junit", own, "is no JUnit report of becalm test"});
  }
  expect_refused({"--json", folder_ / "image.exr"}, 2, {"--json", "image.exr", "is no JSON report"});
  fs::create_directories(folder_ / "site");
  write_text(folder_ / "site/index.html", "<!doctype html><title>mine</title>");
  expect_refused({"--report", folder_ / "site"}, 2,
                 {"--report", "site/index.html", "no page of becalm test"});
}

TEST_F(SuiteReports, AreNotAmongTheSuites) {
  write_suite(shell_case("a"));
  fs::create_directory(folder_ / "suites");
  fs::copy_file(suite_, folder_ / "suites/a.json");
  const std::string inside = folder_ / "suites/results.json";
  expect_error(becalm({"test", folder_ / "suites", "--json", inside}), kUsage,
               {"--json", inside, "would be read as a suite"});
  EXPECT_FALSE(fs::exists(inside));
}

TEST_F(SuiteReports, OfAnEarlierRunAreEmptyWhereTheSuiteIsBad) {
  write_suite(shell_case("a"));
  write_reference("a");
  const std::string junit = folder_ / "results.xml";
  EXPECT_EQ(run({"--junit", junit}).status, 0);
  ASSERT_FALSE(fs::is_empty(junit));
  write_text(suite_, "{}");
  EXPECT_EQ(run({"--junit", junit}).status, kBadInput);
  EXPECT_TRUE(fs::is_empty(junit));
}

TEST_F(SuiteReports, DoNotReplaceEachOther) {
  const std::string both = folder_ / "both.out";
  expect_refused({"--json", both, "--junit", both}, 2, {"--json", both, "another report's"});
  expect_refused({"--report", folder_ / "page", "--json", folder_ / "page/../page/index.html"}, 2,
                 {"--report", "page/index.html", "another report's"});
}

TEST_F(SuiteReports, ReplaceThoseOfTheLastRun) {
  const std::vector<std::string> options{
      "--filter", "good",       "--json", folder_ / "r/results.json", "--junit", folder_ / "r/junit.xml",
      "--report", folder_ / "r"};
  for (int repeat = 0; repeat < 2; ++repeat) {
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
  EXPECT_EQ(files_in(folder_.path() / "r"),
            (std::vector<std::string>{"index.html", "junit.xml", "results.json"}));
  write_text(folder_ / "empty", "");
  EXPECT_EQ(run({"--filter", "good", "--json", folder_ / "empty"}).status, 0);
  const Outcome streams = run({"--filter", "good", "--json", "/dev/stdout", "--junit", "/dev/stdout"});
  EXPECT_NE(streams.out.find("\"peak_memory_bytes\""), std::string::npos) << streams.err;
  EXPECT_NE(streams.out.find("<testsuites"), std::string::npos) << streams.err;
}

TEST_F(SuiteReports, PlacesThatCannotBeWrittenAreToldBeforeTheRun) {
  write_text(folder_ / "none", "a file, no folder");
  const std::string json = folder_ / "ok.json";
  expect_refused({"--junit", folder_ / "none/junit.xml", "--json", json}, 4, {"--junit", "none/junit.xml"});
  expect_refused({"--junit", "/proc/x.xml", "--json", json}, 4, {"--junit", "/proc/x.xml"});
  expect_refused({"--report", folder_ / "none"}, 4, {"--report", "none/index.html"});
  expect_refused({"--json", folder_.path().string()}, 4, {"--json", folder_.path().string()});
}

TEST_F(SuiteReports, AReportThatFailsLeavesTheOthers) {
  const std::string json = folder_ / "ok.json";
  const Outcome outcome = run({"--filter", "good", "--junit", "/dev/full", "--json", json});
  EXPECT_EQ(outcome.status, 4);
  EXPECT_NE(outcome.err.find("--junit /dev/full: cannot write it"), std::string::npos) << outcome.err;
  EXPECT_NE(read_text(json).find("\"passed\": 1"), std::string::npos);
}

TEST_F(SuiteReports, KeptFoldersOfOthersAreToldBeforeTheRun) {
  write_suite(shell_case("good", "cp image.exr $0; touch ran") + "," + shell_case("late"));
  write_reference("late");
  const std::string place = folder_ / "k/suite/late";
  fs::create_directories(place);
  write_text(place + "/precious.txt", "precious");
  expect_refused({"--keep", folder_ / "k"}, 2, {"--keep", place, "files of others"});
  fs::remove_all(folder_ / "k/suite");
  write_text(folder_ / "k/suite", "");
  expect_refused({"--keep", folder_ / "k"}, 4, {"--keep", "k/suite", "Not a directory"});
}

}  // namespace
}  // namespace becalm::test
