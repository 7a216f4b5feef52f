// becalm denoise: which frames are read and written: file names, gaps, cuts, and jobs of parts of a sequence.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/end_to_end/denoise_fixture.h"

namespace becalm::test {
namespace {

TEST_F(Denoise, OneFile) {
  write_frames({7});
  const Outcome outcome = becalm_done({"denoise", folder_ / "in.0007.exr", "-o", folder_ / "one.exr"});
  EXPECT_NE(outcome.err.find("\n1 frame written in"), std::string::npos) << outcome.err;
  EXPECT_FALSE(same_frame("one.exr", "in.0007.exr")) << "a frame alone is smoothed";
  becalm_done(
      {"denoise", folder_ / "in.0007.exr", "-o", folder_ / "one.exr", "--quiet", "--set", "smooth=none"});
  EXPECT_TRUE(same_frame("one.exr", "in.0007.exr")) << "and otherwise stays as it is";
}

TEST_F(Denoise, ASingleFileHasTheNumberOfItsName) {
  write_frames({52});
  const std::string file = folder_ / "in.0052.exr";
  const auto denoise = [&](const std::string& from, const std::string& pattern,
                           const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"denoise", from, "-o", folder_ / pattern, "--set", "smooth=none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return becalm_done(arguments);
  };
  denoise(file, "out.####.exr", {"--quiet"});
  denoise(file, "short.#.exr", {"--quiet"});
  denoise(file, "other.####.exr", {"--quiet", "--frame=-7"});
  fs::rename(file, folder_ / "still.exr");
  const Outcome still = denoise(folder_ / "still.exr", "still.####.exr", {});
  EXPECT_NE(still.err.find("still.exr: no frame number in the name, so this is frame 1; --frame"),
            std::string::npos)
      << still.err;
  EXPECT_EQ(files_in(folder_.path()),
            (std::vector<std::string>{"other.-007.exr", "out.0052.exr", "short.0052.exr", "still.0001.exr",
                                      "still.exr"}));
  write_frames({1, 2});
  expect_error(becalm(command("out.####.exr", {"--frame", "3"})), 2, {"--frame 3", "--frames"});
}

TEST_F(Denoise, ALoneHashOfTheOutputHasThePaddingOfTheInput) {
  write_frames({1, 2});
  becalm_done(command("out/a.#.exr", {"--quiet"}));
  EXPECT_EQ(files_in(folder_.path() / "out"), (std::vector<std::string>{"a.0001.exr", "a.0002.exr"}));
}

TEST_F(Denoise, FilesOfAnotherPaddingArePointedOut) {
  io::write_exr(folder_ / "in.1.exr", noise_frame(1), {});
  expect_error(becalm(command("out.####.exr")), 3, {"no frame", "in.1.exr is there", "in.#.exr"});
  write_frames({2});
  expect_error(becalm(command("out.####.exr", {"--frames", "1-2"})), 3,
               {"frame 1 of", "in.1.exr has another padding"});
}

TEST_F(Denoise, HalvesBesideEachOtherAreOneSequence) {
  for (const int number : {1, 2, 3}) {
    Frame a = noise_frame(number);
    Frame b = noise_frame(number + 10);
    for (Frame* half : {&a, &b}) half->add(Aov::variance, 1e6f);  // of a half, so not of the whole
    io::write_exr(frame_path(folder_ / "shot.b0.####.exr", number), a, {}, io::PixelType::float32);
    io::write_exr(frame_path(folder_ / "shot.b1.####.exr", number), b, {}, io::PixelType::float32);
    Frame whole = noise_frame(number);
    for (const Aov aov : {Aov::beauty, Aov::albedo}) {
      for (std::size_t i = 0; i < whole.image(aov).data().size(); ++i) {
        whole.image(aov).data()[i] = 0.5f * a.image(aov).data()[i] + 0.5f * b.image(aov).data()[i];
      }
    }
    for (const auto& [half, from] : {std::pair{Aov::half_a, &a}, {Aov::half_b, &b}}) {
      Image& radiance = whole.add(half);
      for (std::size_t i = 0; i < radiance.data().size(); ++i) {
        radiance.data()[i] = from->image(Aov::beauty).data()[i / 3 * 4 + i % 3];
      }
    }
    io::write_exr(frame_path(input_, number), whole, {}, io::PixelType::float32);
  }
  becalm_done(command("whole.####.exr"));
  const std::string first = folder_ / "shot.b0.####.exr";
  const std::string second = folder_ / "shot.b1.####.exr";
  EXPECT_NE(becalm_done({"denoise", first, "-o", folder_ / "found.####.exr"})
                .err.find("a half of the samples each"),
            std::string::npos);
  becalm_done({"denoise", first, second, "-o", folder_ / "given.####.exr"});
  for (const char* name : {"found.####.exr", "given.####.exr"}) {
    expect_same_beauty(folder_ / "whole.####.exr", folder_ / name, 1, 3);
  }
  const std::string info = becalm_done({"info", first, "--audit"}).out;
  EXPECT_NE(info.find("is the other half of the samples"), std::string::npos) << info;
  EXPECT_EQ(info.find("times the variance"), std::string::npos) << "the layer is left out: " << info;
  fs::remove(frame_path(second, 2));
  expect_error(becalm({"denoise", first, "-o", folder_ / "gap.####.exr"}), 3,
               {"shot.b1.####.exr: no file for frame 2"});
  const Outcome left_out =
      becalm_done({"denoise", first, "-o", folder_ / "skip.####.exr", "--missing", "skip", "--quiet"});
  EXPECT_EQ(left_out.err.find("damaged"), std::string::npos) << left_out.err;
  EXPECT_NE(left_out.err.find(fmt::format("{} and {}: frame 2 is not on disk in both", first, second)),
            std::string::npos)
      << left_out.err;
  const Outcome alone = becalm_done({"denoise", first, "-o", folder_ / "alone.####.exr", "--no-halves"});
  EXPECT_EQ(alone.err.find("a half of the samples"), std::string::npos) << alone.err;
  EXPECT_FALSE(same_frame("alone.0002.exr", "found.0002.exr"));
  expect_error(becalm({"denoise", first, second, "-o", folder_ / "x.####.exr", "--no-halves"}), 2,
               {"--no-halves"});
}

TEST_F(Denoise, HalvesOfOneSeedAreToldOnce) {
  for (const int number : {1, 2}) {
    for (const char* half : {"shot.b0.####.exr", "shot.b1.####.exr"})
      io::write_exr(frame_path(folder_ / half, number), noise_frame(number), {}, io::PixelType::float32);
  }
  const std::string first = folder_ / "shot.b0.####.exr";
  const std::string told = becalm_done({"denoise", first, "-o", folder_ / "out.####.exr", "--quiet"}).err;
  EXPECT_EQ(told.find("becalm: frame 2: 100 % of the pixels are alike in both halves"), 0u) << told;
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 1) << told;
  EXPECT_NE(becalm_done({"info", first, "--audit"}).out.find("same_halves"), std::string::npos);
}

TEST_F(Denoise, NegativeNumbersKeepTheirSignBeforeThePadding) {
  for (const char* name : {"in.-0001.exr", "in.0000.exr"})
    io::write_exr(folder_ / name, noise_frame(1), {}, io::PixelType::float32);
  becalm_done(command("out/a.####.exr", {"--quiet"}));
  EXPECT_EQ(files_in(folder_.path() / "out"), (std::vector<std::string>{"a.-0001.exr", "a.0000.exr"}));
}

TEST_F(Denoise, WritesEveryFrameOnDiskAndTellsOfGaps) {
  write_frames({1, 2, 5});
  const Outcome outcome = becalm_done(command("out/a.####.exr"));
  EXPECT_EQ(files_in(folder_.path() / "out"),
            (std::vector<std::string>{"a.0001.exr", "a.0002.exr", "a.0005.exr"}));
  EXPECT_NE(outcome.err.find("only frames 1,2,5 are on disk"), std::string::npos) << outcome.err;
}

TEST_F(Denoise, ADamagedFrameIsToldToBeOnDisk) {
  write_frames({1, 2, 3});
  fs::resize_file(folder_ / "in.0002.exr", fs::file_size(folder_ / "in.0002.exr") - 200);
  const Outcome outcome = becalm_done(command("out/a.####.exr", {"--missing", "skip"}));
  EXPECT_NE(outcome.err.find("frame 2 is damaged or not whole yet"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("only frames 1,3 are on disk and whole;"), std::string::npos) << outcome.err;
}

TEST_F(Denoise, StepsAreNotGaps) {
  write_frames({1, 3, 5});
  const Outcome outcome = becalm_done(command("a.####.exr", {"--set", "smooth=none"}));
  EXPECT_EQ(outcome.err.find("on disk"), std::string::npos) << outcome.err;
  EXPECT_FALSE(same_frame("a.0003.exr", "in.0003.exr")) << "the history was dropped";
}

TEST_F(Denoise, MissingSkipStartsAnewAfterTheGap) {
  write_frames({1, 2, 4});
  becalm_done(
      command("skip.####.exr", {"--frames", "1-4", "--missing", "skip", "--quiet", "--set", "smooth=none"}));
  EXPECT_FALSE(fs::exists(folder_ / "skip.0003.exr"));
  EXPECT_TRUE(same_frame("skip.0004.exr", "in.0004.exr")) << "without history the frame stays as it is";
}

TEST_F(Denoise, DamagedFramesCountAsMissingWhereThatGoesOn) {
  write_frames({1, 2, 3, 4});
  std::ofstream(frame_path(input_, 2));
  fs::resize_file(frame_path(input_, 3), fs::file_size(frame_path(input_, 3)) / 2);
  EXPECT_EQ(becalm(command("a.####.exr")).status, 3);
  for (const char* how : {"skip", "hold"}) {
    const std::string output = std::string(how) + ".####.exr";
    const Outcome outcome = becalm_done(command(output, {"--missing", how}));
    EXPECT_NE(outcome.err.find("frames 2,3 are damaged"), std::string::npos) << outcome.err;
    EXPECT_EQ(fs::exists(frame_path(folder_ / output, 3)), how == std::string("hold"));
    EXPECT_TRUE(fs::exists(frame_path(folder_ / output, 4)));
  }
  const Outcome none = becalm(command("b.####.exr", {"--frames", "2", "--missing", "skip"}));
  EXPECT_EQ(none.status, 3);
  EXPECT_NE(none.err.find("none of frames 2 is on disk"), std::string::npos) << none.err;
  const Outcome damaged = becalm(command("b.####.exr", {"--frames", "3", "--missing", "skip"}));
  EXPECT_EQ(damaged.status, 3);
  EXPECT_NE(damaged.err.find("none of frames 3 is on disk and whole"), std::string::npos) << damaged.err;
}

TEST_F(Denoise, ADamagedFrameBetweenOthersIsNoStep) {
  write_frames({1, 2, 3});
  fs::resize_file(frame_path(input_, 2), fs::file_size(frame_path(input_, 2)) / 2);
  becalm_done(command("skip.####.exr", {"--missing", "skip", "--quiet", "--set", "smooth=none"}));
  EXPECT_TRUE(same_frame("skip.0003.exr", "in.0003.exr")) << "without history the frame stays as it is";
}

TEST_F(Denoise, HowToGoOnWithoutAFrameOfDamagedPixelsIsTold) {
  write_frames({1, 2, 3, 4});
  const std::string damaged = frame_path(input_, 2);
  {
    std::fstream file(damaged, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(fs::file_size(damaged) / 4 * 3));
    file << std::string(400, 'U');
  }
  const std::vector<std::string> options{"--preset", "draft", "--missing", "hold", "--resume", "--quiet"};
  expect_error(becalm(command("out.####.exr", options)), 3,
               {damaged, "unsupported EXR", "move the file away", "--missing hold", "--resume"});
  fs::rename(damaged, folder_ / "damaged.exr");
  becalm_done(command("out.####.exr", options));
  EXPECT_EQ(io::read_attribute(folder_ / "out.0002.exr", "becalm:held_from"), "1");
}

TEST_F(Denoise, MissingHoldWritesOneOutputForEachInput) {
  write_frames({1, 2, 5});
  const Outcome outcome = becalm_done(command("hold.####.exr", {"--frames", "1-6", "--missing", "hold"}));
  for (const char* words : {"6 frames written", "frames 3,4,6 are not on disk and hold those before them"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
  const Outcome events =
      becalm_done(command("events.####.exr", {"--frames", "1-6", "--missing", "hold", "--progress", "json"}));
  EXPECT_NE(events.err.find(R"("work_done":6.0,"work_total":6)"), std::string::npos) << events.err;
  fs::remove(folder_ / "events.0004.exr");
  const Outcome resumed = becalm_done(
      command("events.####.exr", {"--frames", "1-6", "--missing", "hold", "--progress", "json", "--resume"}));
  EXPECT_NE(resumed.err.find(R"("work_done":3.0,"work_total":3)"), std::string::npos) << resumed.err;
  EXPECT_TRUE(same_frame("hold.0003.exr", "hold.0002.exr"));
  EXPECT_TRUE(same_frame("hold.0004.exr", "hold.0002.exr"));
  EXPECT_TRUE(same_frame("hold.0006.exr", "hold.0005.exr"));
  EXPECT_EQ(io::read_attribute(folder_ / "hold.0003.exr", "becalm:held_from"), "2");
  EXPECT_EQ(io::read_attribute(folder_ / "hold.0002.exr", "becalm:held_from"), "");
  expect_error(becalm(command("b.####.exr", {"--frames", "0-2", "--missing", "hold"})), 3,
               {"frame 0", "hold"});
}

TEST_F(Denoise, WithoutARangeGapsAreHeldToo) {
  write_frames({1, 2, 4});
  becalm_done(command("hold.####.exr", {"--missing", "hold", "--quiet"}));
  EXPECT_EQ(io::read_attribute(folder_ / "hold.0003.exr", "becalm:held_from"), "2");
}

TEST_F(Denoise, AStrayFrameFarAwayIsNotHeldUpTo) {
  write_frames({1, 2, 2'000'000'000});
  expect_error(becalm(command("hold.####.exr", {"--missing", "hold", "--quiet"})), 3,
               {"between frames 2 and 2000000000", "--frames"});
}

TEST_F(Denoise, HeldFramesMayComeFromTheContext) {
  write_frames({1, 2, 4});
  becalm_done(command("whole.####.exr", {"--frames", "1-4", "--missing", "hold", "--quiet"}));
  becalm_done(command("chunk.####.exr", {"--frames", "3-4", "--missing", "hold", "--quiet"}));
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "chunk.####.exr", 3, 4);
  EXPECT_FALSE(fs::exists(folder_ / "chunk.0002.exr"));
}

TEST_F(Denoise, WhatIsHeldDoesNotDependOnTheRange) {
  write_frames({1, 2, 4});
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--preset", "draft"}, {"--context", "none"}}) {
    std::vector<std::string> options{"--frames", "3-4", "--missing", "hold", "--quiet"};
    options.insert(options.end(), more.begin(), more.end());
    becalm_done(command("out/a.####.exr", options));
    EXPECT_EQ(files_in(folder_.path() / "out"), (std::vector<std::string>{"a.0003.exr", "a.0004.exr"}));
    EXPECT_EQ(io::read_attribute(folder_ / "out/a.0003.exr", "becalm:held_from"), "2");
  }
}

TEST_F(Denoise, RadianceMayBeOfAnySize) {
  const auto write = [&](float scale) {
    for (const int number : {1, 2, 3}) {
      Frame frame = noise_frame(number);
      Image& beauty = frame.image(Aov::beauty);
      for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) beauty.data()[4 * i + c] *= scale;
      }
      io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
    }
  };
  write(1.0f);
  becalm_done(command("usual.####.exr", {"--type", "float", "--quiet"}));
  for (const float scale : {0x1p-96f, 0x1p96f}) {
    write(scale);
    becalm_done(command("scaled.####.exr", {"--type", "float", "--quiet"}));
    const Frame usual = read_frame(folder_ / "usual.0002.exr");
    const Frame scaled = read_frame(folder_ / "scaled.0002.exr");
    for (std::size_t i = 0; i < usual.image(Aov::beauty).data().size(); ++i) {
      const float factor = i % 4 == 3 ? 1.0f : scale;
      ASSERT_EQ(scaled.image(Aov::beauty).data()[i], factor * usual.image(Aov::beauty).data()[i]) << scale;
    }
  }
}

TEST_F(Denoise, ANearlyBlackFirstFrameDoesNotDecideTheScaleOfOthers) {
  write_frames({2, 3});
  const std::vector<std::string> options{"--preset", "draft", "--type", "float", "--cuts", "none", "--quiet"};
  becalm_done(command("alone.####.exr", options));
  Frame black = noise_frame(1);
  std::ranges::fill(black.image(Aov::beauty).data(), 0.0f);
  black.image(Aov::beauty).at(5, 5, 1) = 1e-30f;
  io::write_exr(frame_path(input_, 1), black, {}, io::PixelType::float32);
  becalm_done(command("after.####.exr", options));
  EXPECT_TRUE(same_frame("after.0002.exr", "alone.0002.exr"));
  EXPECT_TRUE(same_frame("after.0003.exr", "alone.0003.exr"));
}

TEST_F(Denoise, NothingIsCarriedOverACut) {
  for (const int number : {1, 2, 3, 4}) {
    Frame frame = noise_frame(number, 24, 16);
    if (number > 2) {
      for (float& v : frame.image(Aov::albedo).data()) v = 1.0f - v;
      for (float& v : frame.image(Aov::normal).data()) v = -v;
    }
    io::write_exr(frame_path(input_, number), frame, {}, io::PixelType::float32);
  }
  const auto denoise = [&](const std::string& pattern, std::vector<std::string> more) {
    more.insert(more.end(), {"--set", "smooth=none"});
    return becalm_done(command(pattern, more));
  };
  const Outcome found = denoise("auto.####.exr", {});
  EXPECT_NE(found.err.find("frame 3: a new shot begins"), std::string::npos) << found.err;
  EXPECT_EQ(found.err.find("shot"), found.err.rfind("shot")) << found.err;
  denoise("given.####.exr", {"--cuts", "3", "--quiet"});
  denoise("second.####.exr", {"--frames", "3-4", "--context", "none", "--quiet"});
  denoise("none.####.exr", {"--cuts", "none", "--quiet"});
  expect_same_beauty(folder_ / "auto.####.exr", folder_ / "given.####.exr", 1, 4);
  expect_same_beauty(folder_ / "auto.####.exr", folder_ / "second.####.exr", 3, 4);
  EXPECT_FALSE(same_frame("auto.0002.exr", "none.0002.exr"));
}

/// Frames first to last as one job, which must be bit for bit those of `whole`.
TEST_F(Denoise, ResultsDoNotDependOnHowASequenceIsCutIntoJobs) {
  for (int number = 1; number <= 24; ++number) write_frames({number});
  const std::vector<std::string> settings{"--segment", "8", "--warmup", "3", "--quiet"};
  const auto job = [&](const std::string& pattern, const std::string& frames,
                       const std::vector<std::string>& options = {}) {
    std::vector<std::string> more = settings;
    if (!frames.empty()) more.insert(more.end(), {"--frames", frames});
    more.insert(more.end(), options.begin(), options.end());
    becalm_done(command(pattern, more));
  };
  job("whole.####.exr", "");
  for (const char* frames : {"1-7", "8-15", "16-24"}) job("chunk.####.exr", frames);
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "chunk.####.exr", 1, 24);
  for (const int frame : {1, 7, 8, 13, 24}) {
    job("single.####.exr", std::to_string(frame));
    expect_same_beauty(folder_ / "whole.####.exr", folder_ / "single.####.exr", frame, frame);
    EXPECT_EQ(io::read_attribute(frame_path(folder_ / "single.####.exr", frame), "becalm:settings"),
              io::read_attribute(frame_path(folder_ / "whole.####.exr", frame), "becalm:settings"));
  }
  job("alone.####.exr", "1", {"--context", "none"});
  EXPECT_FALSE(same_frame("whole.0001.exr", "alone.0001.exr"))
      << "frames after the first say nothing about it";
}

TEST_F(Denoise, DefaultSegmentsMakeJobsIndependentToo) {
  for (int number = 1; number <= 96; ++number) {
    io::write_exr(frame_path(input_, number), noise_frame(number, 24, 16), {}, io::PixelType::float32);
  }
  becalm_done(command("whole.####.exr", {"--frames", "1-96", "--quiet"}));
  for (const char* frames : {"1-31", "32-63", "64-96"}) {
    becalm_done(command("chunk.####.exr", {"--frames", frames, "--quiet"}));
  }
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "chunk.####.exr", 1, 96);
}

TEST_F(Denoise, ContextLimitsWhatIsReadBesidesTheFramesThatAreWritten) {
  write_frames({1, 2, 3, 4, 5});
  becalm_done(
      command("none.####.exr", {"--frames", "3", "--context", "none", "--quiet", "--set", "smooth=none"}));
  EXPECT_TRUE(same_frame("none.0003.exr", "in.0003.exr")) << "alone, a frame stays as it is";
  becalm_done(command("some.####.exr", {"--frames", "3", "--context", "2-4", "--quiet"}));
  EXPECT_EQ(files_in(folder_.path()).size(), 7u) << "context is not written";
  fs::remove(folder_ / "in.0001.exr");
  fs::remove(folder_ / "in.0005.exr");
  becalm_done(command("all.####.exr", {"--frames", "3", "--quiet"}));
  EXPECT_TRUE(same_frame("some.0003.exr", "all.0003.exr"));
  expect_error(becalm(command("a.####.exr", {"--context", "some"})), 2, {"some"});
}

}  // namespace
}  // namespace becalm::test
