// becalm compare: the files that it writes, and how it ends when it is stopped.

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class CompareReport : public testing::Test {
 protected:
  /// The same frame under each of the numbers.
  void write_frames(int count) const {
    for (const std::string& pattern : {reference_, test_}) {
      const std::string first = frame_path(pattern, 1);
      io::write_exr(first, noise_frame(pattern == reference_ ? 1 : 2), {});
      for (int number = 2; number <= count; ++number) fs::create_symlink(first, frame_path(pattern, number));
    }
  }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"compare", reference_, test_};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  TempFolder folder_;
  std::string reference_ = folder_ / "reference.####.exr";
  std::string test_ = folder_ / "test.####.exr";
  std::string report_ = folder_ / "report";
  std::string json_ = folder_ / "figures.json";
};

TEST_F(CompareReport, PicturesReplaceThoseOfTheLastRunAndNothingElse) {
  write_frames(2);
  for (int run = 0; run < 2; ++run) becalm_done(command({"--report", report_}));
  const std::string picture = report_ + "/test.0002.png", linked = report_ + "/error.0001.png";
  const std::string victim = folder_ / "victim.txt";
  write_text(picture, "precious");
  expect_error(becalm(command({"--report", report_})), 2,
               {"--report", picture, "is no picture of becalm compare"});
  EXPECT_EQ(text_of(picture), "precious");
  fs::remove(picture);
  fs::remove(linked);
  write_text(victim, "precious");
  fs::create_symlink(victim, linked);
  const Outcome outcome = becalm(command({"--report", report_}));
  expect_error(outcome, 2, {"--report", linked});
  EXPECT_EQ(outcome.out, "") << "before anything is measured";
  EXPECT_EQ(text_of(victim), "precious");
  fs::remove(linked);
  fs::create_directory(linked);
  EXPECT_EQ(becalm(command({"--report", report_})).status, 4);
}

TEST_F(CompareReport, APictureThatCannotBeWrittenIsAnError) {
  write_frames(1);
  fs::create_directory(report_);
  const std::string picture = report_ + "/error.0001.png";
  fs::create_symlink("/dev/full", picture);
  expect_error(becalm(command({"--report", report_, "--quiet"})), 4,
               {"--report", picture, "cannot write it"});
}

TEST_F(CompareReport, IsWrittenAlthoughNobodyReadsTheTable) {
  write_frames(3);
  const Outcome outcome =
      Process(command({"--json", json_}), R"(exec 3> >(:); wait $!; exec "$0" "$@" >&3 3>&-)").wait();
  expect_error(outcome, 4, {"standard output"});
  EXPECT_EQ(nlohmann::json::parse(text_of(json_))["frames"].size(), 3u);
}

TEST_F(CompareReport, TellsTheFramesBeforeASignal) {
  constexpr int count = 400;
  write_frames(count);
  Process process(command({"--report", report_, "--json", json_}));
  ASSERT_TRUE(wait_until([&] { return fs::exists(report_ + "/error.0002.png"); }));
  process.signal(SIGINT);
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_NE(outcome.err.find("of 400 frames compared"), std::string::npos) << outcome.err;
  const auto json = nlohmann::json::parse(text_of(json_));
  EXPECT_GE(json["frames"].size(), 2u);
  EXPECT_LT(json["frames"].size(), std::size_t{count});
  EXPECT_EQ(json["failures"].size(), 1u) << "a reader sees that frames are missing";
  EXPECT_TRUE(fs::exists(report_ + "/index.html"));
}

TEST_F(CompareReport, RemovesWhatKilledRunsLeft) {
  write_frames(1);
  // No process can have this number: it is beyond the kernel's largest.
  const std::vector<std::string> stale{report_ + "/index.html.partial.99999999.0",
                                       report_ + "/error.0001.png.partial.99999999.3",
                                       json_ + ".partial.99999999.1"};
  const std::string of_others = report_ + "/other.html.partial.99999999.0";
  fs::create_directory(report_);
  for (const std::string& path : stale) write_text(path, "half a file");
  write_text(of_others, "half a file");
  becalm_done(command({"--report", report_, "--json", json_}));
  for (const std::string& path : stale) EXPECT_FALSE(fs::exists(path)) << path;
  EXPECT_TRUE(fs::exists(of_others));
}

}  // namespace
}  // namespace becalm::test
