// becalm info on files and sequences: what it tells, and its exit status.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

class InfoOnSequences : public testing::Test {
 protected:
  void write(int number, const Frame& frame) const { io::write_exr(frame_path(pattern_, number), frame, {}); }
  Frame without_albedo(int number) const {
    Frame frame = noise_frame(number);
    frame.remove(Aov::albedo);
    return frame;
  }

  TempFolder folder_;
  std::string pattern_ = folder_ / "in.####.exr";
};

TEST_F(InfoOnSequences, ASequenceWhoseFramesAreAlikeIsDescribedOnce) {
  for (const int number : {1, 2, 4}) write(number, noise_frame(number));
  const Outcome outcome = becalm_done({"info", pattern_});
  EXPECT_EQ(outcome.out.substr(0, outcome.out.find("\npart")), pattern_ + ": 3 frames, 1,2,4");
  EXPECT_EQ(outcome.out.find("part 0"), outcome.out.rfind("part 0"));
  EXPECT_NE(outcome.out.find("albedo.R"), std::string::npos);
  EXPECT_EQ(outcome.err, "");
}

TEST_F(InfoOnSequences, FramesThatDifferAreToldApart) {
  for (const int number : {2, 3, 4}) write(number, noise_frame(number));
  for (const int number : {1, 5}) write(number, without_albedo(number));
  const Outcome outcome = becalm_done({"info", pattern_});
  EXPECT_NE(outcome.out.find("frames 2-4:\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("frames 1,5 have instead:\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\n-   albedo.R"), std::string::npos) << outcome.out;
  // What is as usual but in columns of another width is no difference.
  EXPECT_EQ(outcome.out.find("beauty.R"), outcome.out.rfind("beauty.R")) << outcome.out;
}

TEST_F(InfoOnSequences, FramesThatBecalmMadeWithOtherSettingsAreToldApart) {
  for (const int number : {1, 2, 3, 4}) {
    const std::string settings = number == 2 ? "spp=64" : "spp=8";
    const io::Attributes attributes{{"becalm:version", "0.1.0"}, {"becalm:settings", settings}};
    if (number < 4) io::write_exr(frame_path(pattern_, number), noise_frame(number), attributes);
  }
  write(4, noise_frame(4));
  const Outcome outcome = becalm_done({"info", pattern_});
  for (const char* words :
       {"frames 1,3:\n", "\nbecalm: version 0.1.0; settings spp=8\nframes 2 have instead:\n",
        "\n+ becalm: version 0.1.0; settings spp=64\n", "frames 4 have instead:\n- becalm: "}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << outcome.out;
  }
  const auto kinds = nlohmann::json::parse(becalm_done({"info", pattern_, "--json"}).out)["kinds"];
  EXPECT_EQ(kinds[1]["becalm"]["settings"], "spp=64") << kinds;
}

TEST_F(InfoOnSequences, FramesArePrintedAsRenderTakesThem) {
  const auto frames_made_from = [&](const std::string& made_from) {
    const io::Attributes attributes{{"becalm:version", "0.1.1"}, {"becalm:made_from", made_from}};
    for (const int number : {1, 3, 5})
      io::write_exr(frame_path(pattern_, number), noise_frame(number), attributes);
    const std::string frames = nlohmann::json::parse(becalm_done({"info", pattern_, "--json"}).out)["frames"];
    const Outcome outcome = becalm_done({"info", pattern_});
    EXPECT_EQ(outcome.out.substr(0, outcome.out.find('\n')), pattern_ + ": 3 frames, " + frames);
    return frames;
  };
  EXPECT_EQ(frames_made_from("1-5x2"), "1-5x2");
  EXPECT_EQ(frames_made_from("1-6"), "1,3,5");
  EXPECT_EQ(frames_made_from("no range"), "1-5x2");
  for (const int number : {2, 4}) write(number, without_albedo(number));
  for (const int number : {6, 7}) write(number, noise_frame(number));
  write(8, without_albedo(8));
  const Outcome outcome = becalm_done({"info", pattern_});
  EXPECT_NE(outcome.out.find("frames 2,4,8 have instead:\n"), std::string::npos) << outcome.out;
}

TEST_F(InfoOnSequences, AuditsFramesThatFollowEachOther) {
  const auto write_noise = [&](int number, int seed) {
    Frame frame = noise_frame(seed);
    frame.remove(Aov::normal);
    write(number, frame);
  };
  const auto audit = [&] {
    return nlohmann::json::parse(becalm_done({"info", pattern_, "--audit", "--json"}).out)["audit"];
  };
  for (const int number : {1, 2, 4, 5}) write_noise(number, number == 4 ? 2 : number);
  EXPECT_EQ(audit().size(), 0u) << audit() << ": frame 4 does not follow frame 2, whose pixels it has";
  write_noise(3, 2);
  EXPECT_EQ(audit().at(0)["check"], "duplicate") << audit();
}

TEST_F(InfoOnSequences, WhatCannotBeDenoisedIsDescribedAndIsAnError) {
  Frame depth(1, 8, 8);
  depth.add(Aov::depth, 1.0f);
  write(1, depth);
  write(2, noise_frame(2));
  write_text(frame_path(pattern_, 3), "no image at all");
  const Outcome one = becalm({"info", frame_path(pattern_, 1)});
  EXPECT_EQ(one.status, kBadInput);
  EXPECT_NE(one.out.find("depth.Z"), std::string::npos);
  EXPECT_EQ(one.out.find("no colour"), std::string::npos) << "data alone on standard output";
  EXPECT_NE(one.err.find("becalm: error: " + frame_path(pattern_, 1) + ": no colour"), std::string::npos)
      << one.err;
  const Outcome all = becalm({"info", pattern_});
  EXPECT_EQ(all.status, kBadInput);
  EXPECT_NE(all.err.find("in.0001.exr: no colour"), std::string::npos) << all.err;
  EXPECT_NE(all.err.find("in.0003.exr: not an EXR file"), std::string::npos) << all.err;
  EXPECT_NE(all.err.find("2 of 3 frames cannot be used\n"), std::string::npos) << all.err;
}

TEST_F(InfoOnSequences, Json) {
  for (const int number : {1, 2}) write(number, noise_frame(number));
  write(3, without_albedo(3));
  write_text(frame_path(pattern_, 4), "no image at all");
  const Outcome outcome = becalm({"info", pattern_, "--json"});
  EXPECT_EQ(outcome.status, kBadInput);
  const nlohmann::json sequence = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(sequence["frames"], "1-4");
  ASSERT_EQ(sequence["kinds"].size(), 2u);
  EXPECT_EQ(sequence["kinds"][0]["frames"], "1,2");
  EXPECT_EQ(sequence["kinds"][0]["parts"][0]["data_window"]["width"], 48);
  EXPECT_EQ(sequence["problems"][0]["frame"], 4);
  const nlohmann::json file =
      nlohmann::json::parse(becalm_done({"info", frame_path(pattern_, 1), "--json"}).out);
  EXPECT_EQ(file["parts"][0]["channels"][0]["use"], "beauty.A");
  EXPECT_EQ(file["problem"], "");
  EXPECT_TRUE(nlohmann::json::parse(becalm_done({"info", "device", "--json"}).out).is_array());
  EXPECT_TRUE(
      nlohmann::json::parse(becalm_done({"info", write_scene(folder_), "--json"}).out)["lines"].is_array());
}

TEST_F(InfoOnSequences, AnAuditTellsWhatWouldSpoilTheResult) {
  const auto write_all = [&](int seed_step, float albedo) {
    for (const int number : {1, 2, 3, 4}) {
      Frame frame = noise_frame(1 + seed_step * number);
      frame.remove(Aov::normal);
      for (float& value : frame.image(Aov::albedo).data()) value *= albedo;
      frame.image(Aov::beauty).at(number, number, 0) += 0.01f;  // no duplicate
      write(number, frame);
    }
  };
  const auto audit = [&] {
    return nlohmann::json::parse(becalm_done({"info", pattern_, "--audit", "--json"}).out)["audit"];
  };
  write_all(1, 1.0f);
  EXPECT_EQ(audit().size(), 0u) << audit();
  EXPECT_NE(becalm_done({"info", frame_path(pattern_, 2), "--audit"}).out.find("audit: nothing found"),
            std::string::npos);
  becalm_done({"denoise", pattern_, "-o", folder_ / "sound.####.exr", "--strict", "--preset", "draft"});

  write_all(0, 3.0f);
  const nlohmann::json findings = audit();
  ASSERT_EQ(findings.size(), 2u) << findings;
  EXPECT_EQ(findings[0]["check"], "fixed_noise");
  EXPECT_EQ(findings[1]["check"], "albedo");
  EXPECT_EQ(findings[1]["frame"], 2);
  const Outcome strict = becalm({"denoise", pattern_, "-o", folder_ / "out.####.exr", "--strict"});
  EXPECT_EQ(strict.status, kBadInput);
  EXPECT_NE(strict.err.find("becalm: frame 2: "), std::string::npos) << strict.err;
  EXPECT_NE(strict.err.find("--strict: 2 findings; nothing was written"), std::string::npos) << strict.err;
  EXPECT_FALSE(fs::exists(folder_ / "out.0001.exr"));
}

TEST_F(InfoOnSequences, FilesOfAnotherPaddingArePointedOut) {
  write(1, noise_frame(1));
  expect_error(becalm({"info", folder_ / "in.##.exr"}), kBadInput, {"in.0001.exr is there", "in.#.exr"});
}

}  // namespace
}  // namespace becalm::test
