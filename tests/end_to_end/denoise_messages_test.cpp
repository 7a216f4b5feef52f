// becalm denoise: what it prints: the plan, progress, the profile.

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <vector>

#include "tests/end_to_end/denoise_fixture.h"

namespace becalm::test {
namespace {

TEST_F(Denoise, ADryRunTellsWhatWouldBeReadAndWrittenAndWritesNothing) {
  write_frames({1, 2, 3});
  const Outcome outcome =
      becalm_done(command("out/a.####.exr", {"--dry-run", "--frames", "2-3", "--type", "half"}));
  EXPECT_EQ(outcome.err, "");
  for (const std::string& words :
       {"reads " + input_ + ": 3 frames, 1-3\n", std::string("takes 48x32 px of beauty=R,G,B,A albedo="),
        std::string("filters with preset balanced on llvmpipe"), std::string(" type=half\n"),
        "writes " + folder_ / "out/a.####.exr" + ": 2 frames, 2,3\n"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
  }
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_EQ(outcome.out.find("replaces"), std::string::npos);
  becalm_done(command("out/a.####.exr", {"--frames", "2", "--quiet"}));
  EXPECT_NE(becalm_done(command("out/a.####.exr", {"--dry-run", "--frames", "2-3"}))
                .out.find("replaces " + folder_ / "out/a.####.exr" + ": 1 frame, 2\n"),
            std::string::npos);
  expect_error(becalm(command("out/a.####.exr", {"--dry-run", "--device", "no such device"})), 4,
               {"no such device"});
  fs::remove(folder_ / "in.0002.exr");
  EXPECT_EQ(becalm(command("out/a.####.exr", {"--dry-run", "--frames", "2-3"})).status, 3);
}

TEST_F(Denoise, GuidesThatAreNotFiniteAreCounted) {
  const float infinity = std::numeric_limits<float>::infinity();
  Frame frame = noise_frame(1);
  frame.image(Aov::albedo).at(3, 4, 1) = std::numeric_limits<float>::quiet_NaN();
  frame.image(Aov::normal).at(3, 4, 0) = infinity;
  frame.image(Aov::normal).at(7, 4, 2) = -infinity;
  frame.add(Aov::depth, infinity).at(9, 9, 0) = std::numeric_limits<float>::quiet_NaN();
  io::write_exr(frame_path(input_, 1), frame, {}, io::PixelType::float32);
  const Outcome outcome = becalm_done(command("out.####.exr"));
  EXPECT_NE(outcome.err.find("frame 1: 3 pixels with NaN or Inf in albedo, normal or depth"),
            std::string::npos)
      << outcome.err;
}

TEST_F(Denoise, NoiseThatNeighboursShareIsPointedOutOnce) {
  constexpr int side = 160;
  const std::string words = "frame 1: neighbouring pixels share noise";
  const auto told = [&](int shared_px) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0.5f, 1.5f);
    for (const int number : {1, 2}) {
      Frame frame(number, side, side);
      Image& beauty = frame.add(Aov::beauty, 1.0f);
      std::vector<float> samples(side * (side + shared_px));
      for (float& sample : samples) sample = uniform(random);
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          float sum = 0.0f;
          for (int i = 0; i < shared_px; ++i) sum += samples[y * (side + shared_px) + x + i];
          for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = sum;
        }
      }
      io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
    }
    const std::string err = becalm_done(command("out.####.exr", {"--quiet", "--preset", "draft"})).err;
    const std::size_t found = err.find("share noise");
    return found != std::string::npos && err.find(words) != std::string::npos &&
           err.find("share noise", found + 1) == std::string::npos;
  };
  EXPECT_FALSE(told(1));
  EXPECT_TRUE(told(2));
}

TEST_F(Denoise, VerboseTellsLayersDeviceHistoryAndFiles) {
  write_frames({1});
  const Outcome outcome = becalm_done(command("out.####.exr", {"-v"}));
  for (const std::string& words :
       {std::string("48x32 px of beauty=R,G,B,A albedo=albedo.R"), std::string("device "),
        std::string("tiles 1\n"),
        std::string("frame 1: 1 frames a pixel on average, 100 % of the history rejected"),
        "reading " + folder_ / "in.0001.exr", "wrote " + folder_ / "out.0001.exr"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << "\n" << outcome.err;
  }
}

TEST_F(Denoise, FramesThatAreFilteredBesidesThoseAskedForAreTold) {
  write_frames({1, 2, 3, 4});
  const std::string words = "3 frames more are read and filtered for those before and after them; --context";
  const auto told = [&](const std::vector<std::string>& more) {
    return becalm_done(command("out.####.exr", more)).err.find(words) != std::string::npos;
  };
  EXPECT_TRUE(told({"--frames", "1"}));
  EXPECT_FALSE(told({"--frames", "1", "--quiet"}));
  EXPECT_FALSE(told({"--frames", "1", "--context", "none"}));
  EXPECT_FALSE(told({}));
}

TEST_F(Denoise, ProgressAsJson) {
  write_frames({1, 2});
  const Outcome outcome = becalm_done(command("out.####.exr", {"--progress", "json", "-v", "--profile"}));
  std::istringstream lines(outcome.err);
  std::vector<int> frames;
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json event = nlohmann::json::parse(line, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(event.is_object()) << line;
    last = event.at("event");
    if (last != "frame") continue;
    frames.push_back(event.at("frame"));
    EXPECT_EQ(event.at("state"), "written");
    EXPECT_EQ(event.at("total"), 2);
  }
  EXPECT_EQ(frames, (std::vector<int>{1, 2}));
  EXPECT_NE(outcome.err.find(R"({"event":"end","written":2,"done":2,"total":2)"), std::string::npos)
      << outcome.err;
  const Outcome resumed = becalm_done(command("out.####.exr", {"--progress", "json", "--resume"}));
  EXPECT_NE(resumed.err.find(R"({"event":"end","written":0,"done":2,"total":2})"), std::string::npos)
      << resumed.err;
  const Outcome failed = becalm(command("out.png", {"--progress", "json"}));
  EXPECT_EQ(failed.status, 2);
  EXPECT_EQ(failed.err.rfind(R"({"event":"error","status":2,"text":"-o )", 0), 0u) << failed.err;
  // Also of options, wherever they stand.
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--progress", "json", "--threads", "many"},
        {"--threads", "many", "--progress=json"},
        {"--no-such", "--progress", "text", "--progress", "json"}}) {
    const Outcome refused = becalm(command("out.####.exr", more));
    EXPECT_EQ(refused.status, 2);
    EXPECT_EQ(refused.err.rfind(R"({"event":"error","status":2,"text":"denoise: )", 0), 0u) << refused.err;
  }
}

TEST_F(Denoise, ProfileTellsWhereTimeAndMemoryWent) {
  write_frames({1, 2});
  const Outcome outcome = becalm_done(command("a.####.exr", {"--profile", "--quiet"}));
  for (const char* words : {"read", "filter", "write", "device time a frame", "align/", "merge/", "MiB held",
                            "peak resident memory"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << "\n" << outcome.err;
  }
}

}  // namespace
}  // namespace becalm::test
