// becalm test: signals, two runs at once, and references that are replaced all or none.

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/end_to_end/suite_fixture.h"

namespace becalm::test {
namespace {

class SuiteStop : public SuiteTest {
 protected:
  /// A case that tells its process, which leads its group, and takes a minute.
  static std::string long_case(const std::string& name, const std::string& before) {
    return shell_case(name, before + " echo $$ >pid.part; mv pid.part pid; sleep 60 & wait");
  }
  /// Waits for that case to run.
  pid_t group_of_case() const {
    EXPECT_TRUE(wait_until([&] { return fs::exists(folder_ / "pid"); }));
    return std::stoi(read_text(folder_ / "pid"));
  }
};

TEST_F(SuiteStop, AnInterruptEndsTheChildren) {
  write_suite(long_case("long", "") + "," + shell_case("next"));
  for (const char* name : {"long", "next"}) write_reference(name);
  Process process({"test", suite_});
  const pid_t group = group_of_case();
  process.signal(SIGINT);
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_NE(outcome.out.find("0 passed, 0 failed, 0 errors, 2 skipped"), std::string::npos) << outcome.out;
  EXPECT_TRUE(wait_until([&] { return kill(-group, 0) != 0; })) << "the child's children run on";
}

TEST_F(SuiteStop, ASecondSignalKillsChildrenThatIgnoreIt) {
  write_suite(long_case("deaf", "trap '' INT TERM;"));
  write_reference("deaf");
  fs::create_directories(folder_ / "tmp");  // becalm leaves its folder there
  Process process({"test", suite_}, "TMPDIR='" + (folder_ / "tmp") + "' exec \"$0\" \"$@\"");
  const pid_t group = group_of_case();
  process.signal(SIGINT);
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().status, 130);
  EXPECT_TRUE(wait_until([&] { return kill(-group, 0) != 0; })) << "the child runs on";
}

TEST_F(SuiteStop, AnInterruptAtTheQuestionChangesNothing) {
  write_suite(shell_case("asked"));
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(grantpt(terminal) | unlockpt(terminal), 0);
  Process process({"test", suite_, "--update"}, fmt::format("exec \"$0\" \"$@\" <{}", ptsname(terminal)));
  EXPECT_TRUE(process.wait_for("[y/N]"));
  process.signal(SIGINT);
  const Outcome stopped = process.wait();
  EXPECT_EQ(stopped.status, 130) << stopped.err;
  EXPECT_NE(stopped.err.find("suite/asked: interrupted"), std::string::npos) << stopped.err;
  EXPECT_FALSE(fs::exists(folder_ / "references/asked/a.0001.exr"));
  close(terminal);
}

TEST_F(SuiteStop, TwoRunsDoNotShareACaseOfAKeptFolder) {
  write_suite(long_case("long", "") + "," + shell_case("other"));
  for (const char* name : {"long", "other"}) write_reference(name);
  const std::string kept = folder_ / "kept";
  Process first({"test", suite_, "--keep", kept, "--filter", "long"});
  const pid_t group = group_of_case();
  expect_error(run({"--keep", kept}), 4, {"kept/suite/long: another becalm", "choose another --keep"});
  EXPECT_EQ(run({"--keep", kept, "--filter", "other"}).status, 0);
  EXPECT_EQ(kill(-group, 0), 0);
  first.signal(SIGINT);
  EXPECT_EQ(first.wait().status, 130);
}

TEST_F(SuiteStop, ReferencesAreReplacedAllOrNone) {
  write_suite(shell_case("both", "cp image.exr $0 #{frame}", R"(, "frames": "1-2")"));
  write_reference("both");
  const std::string before = read_text(folder_ / "references/both/a.0001.exr");
  fs::create_directories(folder_ / "references/both/a.0002.exr");  // which cannot be replaced
  write_image("image.exr", 2);
  const Outcome outcome = run({"--update", "--yes"});
  EXPECT_EQ(outcome.status, 4);
  EXPECT_NE(outcome.err.find("references/both/a.0002.exr: cannot write it: Is a directory"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(read_text(folder_ / "references/both/a.0001.exr"), before);
  EXPECT_EQ(files_in(folder_ / "references/both"), (std::vector<std::string>{"a.0001.exr", "a.0002.exr"}));
}

}  // namespace
}  // namespace becalm::test
