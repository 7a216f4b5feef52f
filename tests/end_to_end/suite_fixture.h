#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/end_to_end/harness.h"

namespace becalm::test {

/// A folder with an image, a scene of 16x16 pixels, and a suite whose cases are written as JSON members.
class SuiteTest : public testing::Test {
 protected:
  static constexpr int kSize = 16;

  SuiteTest() {
    write_image("image.exr", 1);
    write_scene(folder_);
  }

  void write_image(const std::string& name, int number) const {
    io::write_exr(folder_ / name, noise_frame(number, kSize, kSize), {}, io::PixelType::float32);
  }
  void write_suite(const std::string& cases, const std::string& defaults = "{}") const {
    write_text(suite_, fmt::format("{{\"defaults\": {}, \"cases\": {{{}}}}}", defaults, cases));
  }
  /// A case that copies image.exr, or runs another script of the shell.
  static std::string shell_case(const std::string& name, const std::string& script = "cp image.exr $0",
                                const std::string& more = "", const std::string& judge = "\"exact\": true") {
    return fmt::format(
        R"("{}": {{"source": {{"command": ["sh", "-c", "{}", "{{output}}"]{}}}, "judged_by": {{{}}}}})", name,
        script, more, judge);
  }
  /// image.exr as the reference of a case.
  void write_reference(const std::string& name) const {
    fs::create_directories(folder_.path() / "references" / name);
    fs::copy_file(folder_ / "image.exr", folder_ / ("references/" + name + "/a.0001.exr"));
  }
  Outcome run(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"test", suite_});
    return becalm(more);
  }
  Outcome update(const std::string& glob = "*") const {
    Outcome outcome = run({"--update=" + glob, "--yes"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome;
  }
  static std::string read_text(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// The line of a case in what was printed.
  static std::string line_of(const Outcome& outcome, const std::string& name) {
    std::istringstream lines(outcome.out);
    for (std::string line; std::getline(lines, line);) {
      if (line.find(" s  suite/" + name) != std::string::npos) return line;
    }
    return "";
  }

  TempFolder folder_;
  std::string suite_ = folder_ / "suite.json";
};

}  // namespace becalm::test
