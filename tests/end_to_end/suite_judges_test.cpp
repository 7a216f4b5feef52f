// becalm test: scenes judged by statistics, limits, denoised and over time; --update and --calibrate.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/end_to_end/suite_fixture.h"

namespace becalm::test {
namespace {

class SuiteJudges : public SuiteTest {
 protected:
  static std::string scene_case(const std::string& name, const std::string& judges,
                                const std::string& source = "", const std::string& more = "") {
    return fmt::format(
        R"("{}": {{"source": {{"scene": "scene.json", "size": "16x16"{}}}{}, "judged_by": {{{}}}}})", name,
        source, more, judges);
  }
  void replace_in_scene(const std::string& from, const std::string& to) const {
    std::string text = read_text(folder_ / "scene.json");
    text.replace(text.find(from), from.size(), to);
    write_text(folder_ / "scene.json", text);
  }
  /// All light of the fixture's scene times `factor`.
  void scale_light(double factor) const {
    write_scene(folder_);
    replace_in_scene("[0.1, 0.1, 0.2]", fmt::format("[{0}, {0}, {1}]", 0.1 * factor, 0.2 * factor));
    replace_in_scene("[8, 8, 7]", fmt::format("[{0}, {0}, {1}]", 8.0 * factor, 7.0 * factor));
  }
};

TEST_F(SuiteJudges, StatisticsTellNoiseFromAnotherExpectation) {
  write_suite(scene_case("noise", R"("statistical": true)"));
  update();
  for (const char* source : {R"(, "spp": 8, "seed": 2)", R"(, "spp": 4, "seed": 3)"}) {
    write_suite(scene_case("noise", R"("statistical": true)", source));
    const Outcome outcome = run();
    EXPECT_EQ(outcome.status, 0) << outcome.out;
  }
  replace_in_scene("\"emission\": [8, 8, 7]", "\"emission\": [16, 16, 14]");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 1) << outcome.out;
  EXPECT_NE(line_of(outcome, "noise").find("statistical: frame 1"), std::string::npos) << outcome.out;
}

TEST_F(SuiteJudges, StatisticsJudgeRadianceOfAnySize) {
  for (const double factor : {1e-7, 1e-3, 1e5}) {
    scale_light(factor);
    write_suite(scene_case("scaled", R"("statistical": true)"));
    update();
    for (const int seed : {2, 3, 4, 5}) {
      write_suite(scene_case("scaled", R"("statistical": true)", fmt::format(R"(, "seed": {})", seed)));
      const Outcome outcome = run();
      EXPECT_EQ(outcome.status, 0) << factor << outcome.out;
    }
    replace_in_scene("[0.7, 0.6, 0.5]", "[0.6, 0.5, 0.4]");
    EXPECT_EQ(run().status, 1) << factor;
  }
}

/// Halves round dark pixels by more than their noise and end at 65504: those that a command writes, and
/// references of earlier versions.
TEST_F(SuiteJudges, StatisticsAllowForTheRoundingAndTheRangeOfHalves) {
  const std::string halves =
      R"("a": {"source": {"command": ["{becalm}", "render", "scene.json", "-o", "{output}", "--frames", "1",
      "--size", "16x16", "--spp", "{spp}", "--seed", "{seed}", "--aovs", "variance", "-q"]},
      "judged_by": {"statistical": true}})";
  const std::string floats = scene_case("a", R"("statistical": true)");
  const std::string reference = folder_ / "references/a/a.0001.exr";
  for (const double factor : {1e-6, 1e6}) {
    scale_light(factor);
    write_suite(floats);
    update();
    write_suite(halves);
    const Outcome command = run();
    EXPECT_EQ(command.status, 0) << factor << command.out;
    io::write_exr(reference, read_frame(reference, all_aovs()), {{"becalm:reference_spp", "256"}});
    write_suite(floats);
    const Outcome scene = run();
    EXPECT_EQ(scene.status, 0) << factor << scene.out;
  }
  scale_light(1e-6);
  replace_in_scene("[0.7, 0.6, 0.5]", "[0.2, 0.15, 0.1]");
  for (const std::string& frames : {halves, floats}) {
    write_suite(frames);
    EXPECT_EQ(run().status, 1);
  }
}

TEST_F(SuiteJudges, ExactKeepsEveryLayer) {
  write_suite(scene_case("layers", R"("exact": true)", R"(, "aovs": ["albedo", "depth"])"));
  update();
  EXPECT_EQ(run().status, 0);
  replace_in_scene("[0.8, 0.1, 0.1]", "[0.8, 0.1, 0.11]");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(line_of(outcome, "layers").find("frame 1: "), std::string::npos) << outcome.out;
}

TEST_F(SuiteJudges, LimitsHoldForEveryFrameAndForTheSequence) {
  const std::string frames = R"(, "frames": "1-3")";
  write_suite(scene_case("a_loose",
                         R"("perceptual": {"max_flip": 0.9, "min_ssim": 0.01},
                    "error": {"max_rel_mse": 9, "max_temporal_error": 9, "max_energy": 0.5},
                    "sequence": {"max_temporal_error": 9, "max_flicker": 9})",
                         frames, R"(, "reference": {"count": 2, "spp": 64})") +
              "," +
              scene_case("b_tight",
                         R"("perceptual": {"max_flip": 1e-6}, "error": {"max_energy": 1e-9},
                    "sequence": {"max_flicker": 1e-9})",
                         frames, R"(, "reference": {"spp": 64})"));
  update();
  EXPECT_EQ(files_in(folder_.path() / "references/a_loose").size(), 6u);
  const Outcome outcome = run({"--json", folder_ / "results.json"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(line_of(outcome, "a_loose").find("passed"), std::string::npos) << outcome.out;
  const std::string json = read_text(folder_ / "results.json");
  for (const char* words : {"perceptual: FLIP of frame", "(3 of 3 frames)", "error: energy of frame",
                            "sequence: flicker of the sequence"}) {
    EXPECT_NE(json.find(words), std::string::npos) << words << json;
  }
}

TEST_F(SuiteJudges, BothSidesAreDenoised) {
  write_suite(
      scene_case("calm", R"("denoised": {"preset": "draft", "max_rel_mse": 0.05, "max_energy": 0.1})",
                 R"(, "frames": "1-2", "spp": 4)") +
      "," +
      scene_case("filtered", R"("error": {"max_energy": 0.2})", R"(, "frames": "1-2", "denoise": "draft")"));
  update();
  const Outcome same = run();
  EXPECT_EQ(same.status, 0) << same.out;
  replace_in_scene("\"emission\": [8, 8, 7]", "\"emission\": [16, 16, 14]");
  const Outcome brighter = run();
  EXPECT_EQ(brighter.status, 1) << brighter.out;
  EXPECT_NE(line_of(brighter, "calm").find("denoised: denoised"), std::string::npos) << brighter.out;
}

TEST_F(SuiteJudges, FramesBesideTheCasesAreNoContextOfDenoisedOnes) {
  for (int image = 1; image <= 3; ++image) write_image(fmt::format("image{}.exr", image), image);
  write_suite(shell_case("more", "for i in 1 2 3; do cp image$i.exr $(dirname $0)/frame.000$i.exr; done",
                         R"(, "frames": "1-2")", R"("denoised": {"max_rel_mse": 0})"));
  fs::create_directories(folder_ / "references/more");
  for (int frame = 1; frame <= 2; ++frame) {
    fs::copy_file(folder_ / fmt::format("image{}.exr", frame),
                  folder_ / fmt::format("references/more/a.000{}.exr", frame));
  }
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
}

TEST_F(SuiteJudges, WhatAKilledUpdateLeftIsGoneAfterTheNext) {
  write_suite(shell_case("a"));
  fs::create_directories(folder_ / "references/a");
  write_text(folder_ / "references/a/a.0001.exr.partial.99999999.0", "half a file");
  update();
  EXPECT_EQ(files_in(folder_.path() / "references/a"), std::vector<std::string>{"a.0001.exr"});
}

TEST_F(SuiteJudges, UpdateIsNeverSilent) {
  write_suite(scene_case("a", R"("statistical": true)") + "," + scene_case("b", R"("statistical": true)"));
  expect_error(run({"--update"}), 2, {"--update", "--yes"});
  EXPECT_FALSE(fs::exists(folder_ / "references"));
  const Outcome first = update("a");
  EXPECT_NE(first.out.find("references/a/a.0001.exr"), std::string::npos) << first.out;
  EXPECT_NE(first.out.find("KiB, new"), std::string::npos) << first.out;
  EXPECT_FALSE(fs::exists(folder_ / "references/b"));
  replace_in_scene("\"emission\": [8, 8, 7]", "\"emission\": [10, 10, 9]");
  const Outcome second = update("a");
  for (const char* words : {"relMSE", "FLIP", "energy +", "KiB of references in 1 case"}) {
    EXPECT_NE(second.out.find(words), std::string::npos) << words << second.out;
  }
  expect_error(run({"--update=c", "--yes"}), 2, {"--update c"});
  const fs::path outdated = folder_ / "references/a/a.0007.exr";
  const fs::path notes = folder_ / "references/a/notes.txt";
  fs::copy_file(folder_ / "references/a/a.0001.exr", outdated);
  std::ofstream(notes) << "kept";
  EXPECT_NE(update("a").out.find("a.0007.exr: removed"), std::string::npos);
  EXPECT_FALSE(fs::exists(outdated));
  EXPECT_TRUE(fs::exists(notes));
}

TEST_F(SuiteJudges, AnEmptyValueUpdatesAndCalibratesNothing) {
  write_suite(shell_case("a"));
  expect_error(run({"--update=", "--yes"}), 2, {"test: --update: is empty"});
  EXPECT_FALSE(fs::exists(folder_ / "references"));
  expect_error(run({"--calibrate="}), 2, {"test: --calibrate: is empty"});
  expect_error(run({"--keep=", folder_ / "image.exr"}), 2, {"test: --keep: is empty"});
}

TEST_F(SuiteJudges, UpdateGoesOnAfterACaseThatCannotBeMade) {
  write_suite(shell_case("a_crash", "kill -SEGV $$") + "," + shell_case("b_good") + "," +
              shell_case("c_layer", "cp image.exr $0; # {seed}", "", R"("error": {"max_rel_mse": 1})") + "," +
              shell_case("d_good"));
  std::string text = read_text(suite_);
  const std::string judged = R"("judged_by": {"error")";
  text.replace(text.find(judged), judged.size(), R"("layer": "depth", )" + judged);
  write_text(suite_, text);
  const Outcome outcome = run({"--update", "--yes"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_NE(outcome.out.find("KiB of references in 2 cases, 2 failed\n"), std::string::npos) << outcome.out;
  for (const char* words :
       {"becalm: error: suite/a_crash: sh crashed",
        "becalm: error: suite/c_layer: reference_0/frame.0001.exr: no layer depth; channels found: ",
        "albedo.R"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << "\nin: " << outcome.err;
  }
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 2) << outcome.err;
  EXPECT_EQ(files_in(folder_.path() / "references"), (std::vector<std::string>{"b_good", "d_good"}));
}

TEST_F(SuiteJudges, ReportsAndOtherWorkAreRefusedWhereTheyWouldBeIgnored) {
  write_suite(shell_case("a"));
  for (const char* work : {"--update=a", "--calibrate=3", "--list"}) {
    for (const char* report : {"--junit", "--json", "--report"}) {
      expect_error(run({work, report, folder_ / "report"}), 2, {report, "excludes"});
    }
  }
  for (const char* work : {"--update=a", "--calibrate=3"}) {
    expect_error(run({work, "--jobs", "2"}), 2, {"--jobs", "excludes"});
    expect_error(run({work, "--fail-fast"}), 2, {"--fail-fast", "excludes"});
  }
  expect_error(run({"--calibrate=3", "--update=a"}), 2, {"--calibrate", "excludes", "--update"});
  expect_error(run({"--list", "--update=a"}), 2, {"--list", "excludes", "--update"});
  expect_error(run({"--list", "--calibrate=3"}), 2, {"--list", "excludes", "--calibrate"});
  EXPECT_FALSE(fs::exists(folder_ / "references"));
  EXPECT_FALSE(fs::exists(folder_ / "report"));
}

TEST_F(SuiteJudges, AReferenceThatCannotBeMadeIsTold) {
  write_suite(shell_case("crash", "kill -SEGV $$"));
  const Outcome outcome = run({"--update", "--yes"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.err.find("suite/crash: sh crashed"), std::string::npos) << outcome.err;
  write_suite(shell_case("noise", "cp image.exr $0", "", R"("statistical": true)"));
  expect_error(run({"--update", "--yes"}), 3, {"/cases/noise/source/command", "{seed}"});
  write_suite(shell_case("noise", "cp image.exr $0; # {seed}", "", R"("statistical": true)"));
  expect_error(run({"--update", "--yes"}), 3, {"suite/noise", "frame 1 has no layer variance"});
  write_suite(shell_case("text", "echo no picture >$0"));
  expect_error(run({"--update", "--yes"}), 3, {"frame.0001.exr"});
  Frame broken = noise_frame(1, kSize, kSize);
  broken.image(Aov::beauty).at(3, 4, 1) = std::numeric_limits<float>::quiet_NaN();
  io::write_exr(folder_ / "broken.exr", broken, {}, io::PixelType::float32);
  write_suite(shell_case("broken", "cp broken.exr $0"));
  expect_error(run({"--update", "--yes"}), 3, {"suite/broken", "frame 1 has pixels that are not finite"});
  EXPECT_FALSE(fs::exists(folder_ / "references"));
}

TEST_F(SuiteJudges, OnlyInDepthIsInfinityAValue) {
  Frame frame = noise_frame(1, kSize, kSize);
  for (const Aov aov : {Aov::direct, Aov::depth}) frame.add(aov, 0.5f);
  frame.image(Aov::direct).at(3, 4, 1) = std::numeric_limits<float>::infinity();
  frame.image(Aov::depth).at(3, 4, 0) = std::numeric_limits<float>::infinity();
  io::write_exr(folder_ / "image.exr", frame, {}, io::PixelType::float32);
  const auto write_case_of = [&](const std::string& layer) {
    write_suite(fmt::format(
        R"("a": {{"source": {{"command": ["sh", "-c", "cp image.exr $0; # {{seed}}", "{{output}}"]}}, "layer": "{}",
           "judged_by": {{"error": {{"max_rel_mse": 1}}}}}})",
        layer));
  };
  write_case_of("depth");
  update();
  EXPECT_EQ(run().status, 0);
  write_case_of("direct");
  expect_error(run({"--update", "--yes"}), 3, {"suite/a", "frame 1 has pixels that are not finite"});
}

TEST_F(SuiteJudges, ACaseMayHaveNoneOfTheLayersOfItsDefaults) {
  const std::string defaults = R"({"source": {"aovs": ["albedo"]}})";
  write_suite(scene_case("a", R"("statistical": true)", R"(, "aovs": ["none"])"), defaults);
  update();
  EXPECT_EQ(run().status, 0);
}

TEST_F(SuiteJudges, ReferencesRecordTheSamplesThatTheyWereAskedFor) {
  const auto recorded = [&](const std::string& script) {
    write_suite(shell_case("a", script, ", \"spp\": 4", R"("error": {"max_rel_mse": 1})"));
    update();
    return io::read_attribute(folder_ / "references/a/a.0001.exr", "becalm:reference_spp");
  };
  EXPECT_EQ(recorded("cp image.exr $0; # {seed}"), "4");
  EXPECT_EQ(recorded("cp image.exr $0; # {seed} {spp}"), "64");
}

TEST_F(SuiteJudges, CalibrateProposesLimitsThatOtherSeedsPass) {
  write_suite(scene_case("a", R"("error": {"max_rel_mse": 1, "max_energy": 1}, "statistical": true)"));
  update();
  const Outcome outcome = run({"--calibrate=5"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* words : {"5 seeds, false-alarm rate 0.001", "statistical: 0 of 5 frames failed",
                            "error max_rel_mse: ", "limit 1 in the suite", "\"judged_by\": {\"error\":"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << outcome.out;
  }
}

TEST_F(SuiteJudges, CalibrateTellsWhatCannotBeMeasured) {
  for (const int number : {1, 2}) {
    io::write_compact_exr(folder_ / fmt::format("moves.{}.exr", number), noise_frame(number, kSize, kSize),
                          {}, Imath::V2i(kSize * number, 0));
  }
  write_suite(shell_case("a", "cp moves.{frame}.exr $0; # {seed}", R"(, "frames": "1-2")",
                         R"("error": {"max_rel_mse": 1, "max_temporal_error": 1})"));
  update();
  expect_error(run({"--calibrate=5"}), 3, {"suite/a: error max_temporal_error: cannot be measured"});
}

}  // namespace
}  // namespace becalm::test
