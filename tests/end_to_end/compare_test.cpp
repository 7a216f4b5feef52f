// becalm compare, info, --help and --version.

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

class Compare : public testing::Test {
 protected:
  /// A reference and a test that is brighter by the factor.
  void write_frames(int count, float factor) const {
    for (int number = 1; number <= count; ++number) {
      Frame frame = noise_frame(number);
      io::write_exr(frame_path(reference_, number), frame, {}, io::PixelType::float32);
      for (float& value : frame.image(Aov::beauty).data()) value *= factor;
      io::write_exr(frame_path(test_, number), frame, {}, io::PixelType::float32);
    }
  }

  TempFolder folder_;
  std::string reference_ = folder_ / "reference.####.exr";
  std::string test_ = folder_ / "test.####.exr";
};

TEST_F(Compare, EqualSequencesHaveNoError) {
  write_frames(2, 1.0f);
  const Outcome outcome =
      becalm_done({"compare", reference_, test_, "--max-relmse", "0", "--max-temporal", "0", "--max-energy",
                   "0", "--min-ssim", "0.9999", "--min-psnr", "100", "--max-flip", "0"});
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 4) << outcome.out;
  for (const char* word : {"relMSE", "PSNR", "SSIM", "FLIP", "temporal", "energy", "mean"}) {
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  }
}

TEST_F(Compare, EqualFramesMeetEveryLimit) {
  write_frames(1, 1.0f);
  becalm_done({"compare", reference_, test_, "--min-ssim", "1", "--min-psnr", "1000", "--max-flip", "0"});
}

TEST_F(Compare, ASecondReferenceIsAnother) {
  write_frames(1, 1.1f);
  for (const std::string& given : {reference_, test_}) {
    expect_error(becalm({"compare", reference_, test_, "--reference-b", given}), kUsage,
                 {"--reference-b", given, "is given twice"});
  }
}

TEST_F(Compare, ARunThatFailsEmptiesTheReportOfAnother) {
  write_frames(2, 1.1f);
  const std::string json = folder_ / "figures.json";
  becalm_done({"compare", reference_, test_, "--json", json});
  fs::remove(frame_path(test_, 2));
  EXPECT_EQ(becalm({"compare", reference_, test_, "--json", json}).status, kBadInput);
  EXPECT_TRUE(fs::is_empty(json));
  write_text(json, "{}");
  EXPECT_EQ(becalm({"compare", reference_, test_, "--json", json}).status, kBadInput);
  EXPECT_FALSE(fs::is_empty(json)) << "it is no report";
}

TEST_F(Compare, EveryLimitFailsOnItsOwnLine) {
  write_frames(3, 1.2f);
  const Outcome outcome =
      becalm({"compare", reference_, test_, "--max-relmse", "0.001", "--max-temporal", "0.001",
              "--max-energy", "0.1", "--min-ssim", "0.99999", "--min-psnr", "60", "--max-flip", "0.001"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 6) << outcome.err;
  for (const char* option :
       {"--max-relmse", "--max-temporal", "--max-energy", "--min-ssim", "--min-psnr", "--max-flip"}) {
    EXPECT_NE(outcome.err.find(option), std::string::npos) << option << "\n" << outcome.err;
  }
  EXPECT_EQ(becalm({"compare", reference_, test_, "--max-energy", "0.21"}).status, 0);
  EXPECT_EQ(becalm({"compare", reference_, test_, "--max-energy", "0.19"}).status, 1);
}

TEST_F(Compare, TheLayerMayBeNamed) {
  Frame frame(1, 8, 8);
  frame.add(Aov::albedo, 0.5f);
  for (const std::string& pattern : {reference_, test_}) io::write_exr(frame_path(pattern, 1), frame, {});
  const Outcome without = becalm({"compare", reference_, test_});
  EXPECT_EQ(without.status, 3);
  EXPECT_NE(without.err.find("--layers"), std::string::npos) << without.err;
  becalm_done({"compare", reference_, test_, "--layers", "beauty=albedo", "--max-relmse", "0"});
}

TEST_F(Compare, OneBadFrameFailsALimit) {
  write_frames(3, 1.0f);
  Frame frame = noise_frame(2);
  for (float& value : frame.image(Aov::beauty).data()) value *= 2.0f;
  io::write_exr(frame_path(test_, 2), frame, {}, io::PixelType::float32);
  const Outcome outcome = becalm({"compare", reference_, test_, "--max-relmse", "0.5"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("frame 2"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("1 of 3 frames"), std::string::npos) << outcome.err;
}

TEST_F(Compare, TheWorstFrameIsNamedWhateverItsSign) {
  write_frames(3, 1.0f);
  for (const auto& [number, factor] : {std::pair{1, 0.5f}, std::pair{2, 0.8f}, std::pair{3, 1.2f}}) {
    Frame frame = noise_frame(number);
    for (float& value : frame.image(Aov::beauty).data()) value *= factor;
    io::write_exr(frame_path(test_, number), frame, {}, io::PixelType::float32);
  }
  const Outcome outcome = becalm({"compare", reference_, test_, "--max-energy", "0.1"});
  EXPECT_NE(outcome.err.find("energy of frame 1 is -50.000 %"), std::string::npos) << outcome.err;
}

TEST_F(Compare, ALimitThatNothingWasMeasuredForFails) {
  write_frames(1, 1.0f);
  const Outcome outcome = becalm({"compare", reference_, test_, "--max-temporal", "1"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("--max-temporal"), std::string::npos) << outcome.err;
}

TEST_F(Compare, NothingFiniteIsAFailure) {
  write_frames(1, std::numeric_limits<float>::quiet_NaN());
  const Outcome outcome = becalm({"compare", reference_, test_, "--max-relmse", "1"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("not finite"), std::string::npos) << outcome.err;
}

TEST_F(Compare, PixelsThatAreNotFiniteAreWithinNoLimit) {
  write_frames(1, 1.0f);
  for (const std::string& pattern : {test_, reference_}) {
    Frame frame = noise_frame(1);
    frame.image(Aov::beauty).at(5, 7, 1) = std::numeric_limits<float>::quiet_NaN();
    const std::string path = frame_path(pattern, 1);
    const std::string kept = path + ".kept";
    fs::rename(path, kept);
    io::write_exr(path, frame, {}, io::PixelType::float32);
    const Outcome outcome = becalm({"compare", reference_, test_, "--max-relmse", "1"});
    EXPECT_EQ(outcome.status, 1) << path;
    EXPECT_NE(outcome.err.find("1 pixels of frame 1"), std::string::npos) << outcome.err;
    EXPECT_EQ(becalm({"compare", reference_, test_}).status, 0) << "without a limit nothing fails";
    fs::rename(kept, path);
  }
}

TEST_F(Compare, AnyViewOfAStereoFileIsMeasured) {
  Frame left = noise_frame(1);
  Frame right = noise_frame(2);
  io::write_exr(folder_ / "a.exr", std::vector<io::WrittenView>{{"left", &left}, {"right", &right}}, {});
  for (float& value : right.image(Aov::beauty).data()) value *= 2.0f;
  io::write_exr(folder_ / "b.exr", std::vector<io::WrittenView>{{"left", &left}, {"right", &right}}, {});
  const auto compared = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"compare", folder_ / "a.exr", folder_ / "b.exr", "--max-relmse", "0.1"};
    words.insert(words.end(), more.begin(), more.end());
    return becalm(words);
  };
  const Outcome first = compared({});
  EXPECT_EQ(first.status, 0);
  EXPECT_NE(first.err.find("--view"), std::string::npos) << first.err;
  EXPECT_EQ(compared({"--view", "left"}).err, "");
  EXPECT_EQ(compared({"--view", "right"}).status, 1);
  EXPECT_EQ(compared({"--view", "middle"}).status, 3);
}

/// Moves windows in a file's header by some pixels to the right.
void move_windows(const std::string& path, const std::vector<std::string>& names, int by) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  for (const std::string& name : names) {
    const std::size_t at = bytes.find(name) + name.size() + std::string("?box2i?").size() + 4;
    for (const std::size_t x : {at, at + 8}) bytes[x] = static_cast<char>(bytes[x] + by);
  }
  write_text(path, bytes);
}

TEST_F(Compare, PixelsAreComparedWhereTheyLie) {
  write_frames(1, 1.0f);
  const std::string moved = folder_ / "moved.exr";
  fs::copy_file(frame_path(reference_, 1), moved);
  move_windows(moved, {"dataWindow", "displayWindow"}, 1);
  const Outcome outcome = becalm({"compare", frame_path(reference_, 1), moved});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.err.find("(1, 0)"), std::string::npos) << outcome.err;
}

TEST_F(Compare, TheTemporalErrorIsThatOfPixelsThatBothFramesHave) {
  write_frames(3, 1.0f);
  // A pixel that is wrong, once only: in the first column, which the next frame's window does not reach.
  Frame wrong = noise_frame(1);
  wrong.image(Aov::beauty).at(0, 5, 1) += 100.0f;
  io::write_exr(frame_path(test_, 1), wrong, {}, io::PixelType::float32);
  for (int number = 1; number <= 3; ++number) {
    for (const std::string& pattern : {reference_, test_})
      move_windows(frame_path(pattern, number), {"dataWindow"}, number);
  }
  const std::string json = folder_ / "figures.json";
  becalm_done({"compare", reference_, test_, "--max-temporal", "0", "--json", json});
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(json))["frames"][1]["temporal"], 0.0);
  move_windows(frame_path(reference_, 2), {"dataWindow"}, 60);
  move_windows(frame_path(test_, 2), {"dataWindow"}, 60);
  EXPECT_EQ(becalm({"compare", reference_, test_, "--max-temporal", "0"}).status, 1) << "nothing in common";
}

TEST_F(Compare, FramesOfOtherSizesHaveNoTemporalError) {
  for (int number = 1; number <= 3; ++number) {
    const Frame frame = noise_frame(number, number == 1 ? 24 : 32, 16);
    for (const std::string& pattern : {reference_, test_})
      io::write_exr(frame_path(pattern, number), frame, {}, io::PixelType::float32);
  }
  const std::string json = folder_ / "figures.json";
  becalm_done({"compare", reference_, test_, "--json", json});
  const auto figures = nlohmann::json::parse(std::ifstream(json));
  EXPECT_TRUE(figures["frames"][1]["temporal"].is_null());
  EXPECT_EQ(figures["frames"][2]["temporal"], 0.0);
}

TEST_F(Compare, FramesOfAStepHaveATemporalError) {
  for (const int number : {1, 3, 5, 9}) {
    for (const std::string& pattern : {reference_, test_})
      io::write_exr(frame_path(pattern, number), noise_frame(number, 32, 16), {}, io::PixelType::float32);
  }
  const std::string json = folder_ / "figures.json";
  becalm_done({"compare", reference_, test_, "--json", json});
  const auto frames = nlohmann::json::parse(std::ifstream(json))["frames"];
  EXPECT_EQ(frames[1]["temporal"], 0.0);
  EXPECT_EQ(frames[2]["temporal"], 0.0);
  EXPECT_TRUE(frames[3]["temporal"].is_null()) << "after a gap";
  becalm_done({"compare", reference_, test_, "--json", json, "--frames", "1,5"});
  EXPECT_TRUE(nlohmann::json::parse(std::ifstream(json))["frames"][1]["temporal"].is_null());
}

TEST_F(Compare, JsonTellsWhatIsInfiniteFromWhatWasNotMeasured) {
  write_frames(1, 1.0f);
  const std::string json = folder_ / "figures.json";
  becalm_done({"compare", reference_, test_, "--json", json});
  const auto figures = nlohmann::json::parse(std::ifstream(json));
  for (const nlohmann::json& row : {figures["frames"][0], figures["mean"]}) {
    EXPECT_EQ(row["psnr"], "inf");
    EXPECT_TRUE(row["temporal"].is_null());
  }
}

TEST_F(Compare, NamesThatAreNoTextAreWritten) {
  write_frames(1, 2.0f);
  const std::string odd = folder_ /
                          "r\xe9"
                          "f.exr";
  fs::copy_file(frame_path(reference_, 1), odd);
  const std::string json = folder_ / "figures.json";
  const Outcome outcome =
      becalm({"compare", odd, frame_path(test_, 1), "--max-relmse", "0.01", "--json", json});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(json))["failures"].size(), 1u);
}

TEST_F(Compare, ReportsReplaceFilesWhole) {
  write_frames(1, 1.0f);
  const fs::path json = fs::path(folder_ / "new") / "figures.json";
  const auto compare_to = [&](const std::string& place) {
    return becalm({"compare", reference_, test_, "--json", place});
  };
  ASSERT_EQ(compare_to(json).status, 0) << "makes the folder";
  const fs::path link = folder_ / "link.json";
  const fs::path before = folder_ / "before.json";
  fs::create_symlink(json, link);
  fs::create_hard_link(json, before);
  const auto figures = nlohmann::json::parse(std::ifstream(before));
  write_frames(1, 1.1f);
  ASSERT_EQ(compare_to(link).status, 0);
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(before)), figures) << "not written over, but replaced";
  EXPECT_TRUE(nlohmann::json::parse(std::ifstream(json)).contains("mean")) << "behind the link";
  EXPECT_NE(compare_to("/dev/stdout").out.find("\"mean\""), std::string::npos);
  EXPECT_EQ(compare_to(frame_path(test_, 1)).status, 2) << "frames are not replaced";
  const Outcome of_folder = compare_to(json.parent_path());
  EXPECT_EQ(of_folder.status, 4);
  EXPECT_NE(of_folder.err.find("--json"), std::string::npos) << of_folder.err;
}

TEST_F(Compare, ReportsReplaceNothingElse) {
  write_frames(1, 1.0f);
  const std::string report = folder_ / "site", page = report + "/index.html", json = folder_ / "own.json";
  const std::vector<std::string> both{"compare", reference_, test_, "--report", report, "--json", json};
  fs::create_directories(report);
  write_text(page, "<!doctype html><title>mine</title>");
  const auto size = fs::file_size(page);
  const Outcome outcome = becalm(both);
  expect_error(outcome, 2, {"--report", page, "is no page of becalm compare"});
  EXPECT_EQ(outcome.out, "") << "before anything is measured";
  EXPECT_EQ(fs::file_size(page), size);
  EXPECT_EQ(files_in(report).size(), 1u);
  fs::remove(page);
  write_text(json, R"({"mean": 1, "frames": []})");
  expect_error(becalm(both), 2, {"--json", json, "is no JSON report of becalm compare"});
  write_text(json, "");
  for (int run = 0; run < 2; ++run) EXPECT_EQ(becalm(both).status, 0) << "what is empty, and its own";
  expect_error(becalm({"compare", reference_, test_, "--report", report, "--json", page}), 2,
               {"--json", page, "another report's"});
}

TEST_F(Compare, LimitsAreNumbersThatCanBeMet) {
  write_frames(1, 1.0f);
  for (const char* value : {"nan", "-1", "inf", "x"}) {
    EXPECT_EQ(becalm({"compare", reference_, test_, "--max-relmse", value}).status, 2) << value;
  }
  EXPECT_EQ(becalm({"compare", reference_, test_, "--min-ssim", "2"}).status, 2);
  EXPECT_EQ(becalm({"compare", reference_, test_, "--min-psnr", "-3"}).status, 0);
}

TEST_F(Compare, TheNoiseOfTwoReferencesIsNoError) {
  const std::string second = folder_ / "second.0001.exr";
  Frame truth(1, 64, 64);
  for (float& value : truth.add(Aov::beauty).data()) value = 0.5f;
  const auto write_noisy = [&](const std::string& path, int number) {
    const Frame noise = noise_frame(number, 64, 64);
    Frame frame = truth;
    for (std::size_t i = 0; i < frame.image(Aov::beauty).data().size(); ++i) {
      frame.image(Aov::beauty).data()[i] += 0.2f * (noise.image(Aov::beauty).data()[i] - 0.5f);
    }
    io::write_exr(path, frame, {}, io::PixelType::float32);
  };
  io::write_exr(frame_path(test_, 1), truth, {}, io::PixelType::float32);
  write_noisy(frame_path(reference_, 1), 1);
  write_noisy(second, 2);
  EXPECT_EQ(becalm({"compare", reference_, test_, "--max-relmse", "0.002"}).status, 1);
  EXPECT_EQ(becalm({"compare", reference_, test_, "--reference-b", second, "--max-relmse", "0.002"}).status,
            0);
}

TEST_F(Compare, WritesAReportAndJson) {
  write_frames(2, 1.1f);
  becalm_done(
      {"compare", reference_, test_, "--report", folder_ / "report", "--json", folder_ / "figures.json"});
  EXPECT_EQ(files_in(folder_.path() / "report"),
            (std::vector<std::string>{"error.0001.png", "error.0002.png", "index.html", "reference.0001.png",
                                      "reference.0002.png", "test.0001.png", "test.0002.png"}));
  std::ifstream file(folder_ / "figures.json");
  const auto json = nlohmann::json::parse(file);
  ASSERT_EQ(json["frames"].size(), 2u);
  EXPECT_TRUE(json["frames"][0]["temporal"].is_null());
  EXPECT_GT(json["frames"][1]["temporal"].get<double>(), 0.0);
  EXPECT_GT(json["mean"]["flip"].get<double>(), 0.0);
  EXPECT_NEAR(json["mean"]["energy"].get<double>(), 0.1, 1e-4);
}

TEST_F(Compare, NamesFilesThatDoNotFit) {
  write_frames(1, 1.0f);
  io::write_exr(frame_path(test_, 1), noise_frame(1, 40, 32), {});
  const Outcome sizes = becalm({"compare", frame_path(reference_, 1), frame_path(test_, 1)});
  EXPECT_EQ(sizes.status, 3);
  for (const char* word : {"test.0001.exr", "40x32", "48x32"})
    EXPECT_NE(sizes.err.find(word), std::string::npos);
}

TEST_F(Compare, FramesBeforeADamagedOneAreToldInTheirOrder) {
  write_frames(8, 1.1f);
  write_text(frame_path(test_, 7), "no image");
  const Outcome outcome = becalm({"compare", reference_, test_, "--threads", "4"});
  EXPECT_EQ(outcome.status, kBadInput);
  EXPECT_NE(outcome.err.find("test.0007.exr: not an EXR file"), std::string::npos) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string line;
  std::getline(lines, line);
  for (int number = 1; number <= 6; ++number) {
    std::getline(lines, line);
    EXPECT_EQ(std::stoi(line), number) << outcome.out;
  }
  EXPECT_FALSE(std::getline(lines, line)) << line;
}

TEST_F(Compare, FramesThatAreNotThereAreToldBeforeAnythingIsMeasured) {
  for (int frame = 1; frame <= 4; ++frame) write_frames(frame, 1.0f);
  for (const int frame : {2, 4}) fs::remove(frame_path(test_, frame));
  const Outcome outcome = becalm({"compare", reference_, test_});
  expect_error(outcome, 3, {"test.0002.exr", "no file for frame 2,4 of 4 frames"});
  EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  const Outcome single = becalm({"compare", frame_path(reference_, 1), frame_path(test_, 2)});
  EXPECT_EQ(single.status, 3);
  EXPECT_NE(single.err.find("test.0002.exr: no such file"), std::string::npos) << single.err;
}

TEST(Info, DescribesScenesFilesSequencesAndDevices) {
  const TempFolder folder;
  const std::string scene = becalm_done({"info", write_scene(folder)}).out;
  EXPECT_NE(scene.find("48x32"), std::string::npos) << scene;
  EXPECT_NE(scene.find("left out"), std::string::npos) << scene;
  io::write_exr(folder / "a.0001.exr", noise_frame(1), {});
  io::write_exr(folder / "a.0002.exr", noise_frame(2), {});
  EXPECT_NE(becalm_done({"info", folder / "a.0001.exr"}).out.find("albedo.R"), std::string::npos);
  EXPECT_NE(becalm_done({"info", folder / "a.####.exr"}).out.find("2 frames, 1,2"), std::string::npos);
  EXPECT_EQ(becalm_done({"info", "device"}).out.rfind("0: ", 0), 0u);
  expect_error(becalm({"info", folder / "none.exr"}), 3, {"none.exr"});
}

TEST(Program, LoadsOpenImageIOForThePicturesAloneAndNeedsNoFileBesideIt) {
  // The dynamic linker prints what it would load.
  const Outcome libraries = Process({}, R"(LD_TRACE_LOADED_OBJECTS=1 "$0")").wait();
  EXPECT_NE(libraries.out.find("libOpenEXR"), std::string::npos) << libraries.out;
  EXPECT_EQ(libraries.out.find("libOpenImageIO"), std::string::npos) << libraries.out;
  const TempFolder folder;
  for (const char* name : {"a.exr", "b.exr"}) io::write_exr(folder / name, noise_frame(name[0]), {});
  const Outcome moved = Process({folder.path().string()}, R"(cd "$1" && cp "$0" moved && )"
                                                          R"(./moved compare a.exr b.exr --report report)")
                            .wait();
  EXPECT_EQ(moved.status, 0) << moved.err;
  EXPECT_TRUE(fs::exists(folder.path() / "report/test.0001.png")) << moved.err;
}

TEST(Help, IsOnStandardOutputAndListsEverything) {
  const Outcome top = becalm_done({"--help"});
  for (const char* word : {"render", "denoise", "compare", "info", "Examples", "130 interrupted"}) {
    EXPECT_NE(top.out.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(top.err, "");
  EXPECT_EQ(becalm_done({"--version"}).out.rfind("becalm ", 0), 0u);
  for (const char* command : {"render", "denoise", "compare", "info"}) {
    const Outcome outcome = becalm_done({command, "--help"});
    EXPECT_NE(outcome.out.find(std::string("Usage: becalm ") + command), std::string::npos) << outcome.out;
    std::istringstream lines(outcome.out);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 106u) << line;
    EXPECT_LE(count, 45u) << "does not fit a screen: " << outcome.out;
  }
  for (const char* command : {"render", "denoise"}) {
    const std::string common = becalm_done({command, "--help"}).out;
    const Outcome all = becalm_done({command, "--help-all"});
    EXPECT_EQ(all.err, "");
    for (const char* option : {"--segment", "--context", "--overwrite", "--progress text|json"}) {
      EXPECT_EQ(common.find(option), std::string::npos) << option;
      EXPECT_NE(all.out.find(option), std::string::npos) << option;
    }
    std::istringstream words(common);
    for (std::string word; words >> word;) EXPECT_NE(all.out.find(word), std::string::npos) << word;
  }
  const std::string denoise = becalm_done({"denoise", "--help-settings"}).out;
  for (const char* words : {"match_downsample", "draft: 4; balanced: 2; final: 1", "variance; paper: mask"}) {
    EXPECT_NE(denoise.find(words), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace becalm::test
