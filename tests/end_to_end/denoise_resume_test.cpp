// becalm denoise: --resume, and output files that exist.

#include <gtest/gtest.h>

#include "tests/end_to_end/denoise_fixture.h"

namespace becalm::test {
namespace {

TEST_F(Denoise, ResumeGivesTheSamePixels) {
  write_frames({1, 2, 3, 4});
  becalm_done(command("whole.####.exr"));
  becalm_done(command("a.####.exr"));
  fs::remove(folder_ / "a.0002.exr");
  fs::remove(folder_ / "a.0003.exr");
  const auto first = fs::last_write_time(folder_ / "a.0001.exr");
  becalm_done(command("a.####.exr", {"--resume"}));
  EXPECT_EQ(fs::last_write_time(folder_ / "a.0001.exr"), first);
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 4);
  const Outcome again = becalm_done(command("a.####.exr", {"--resume"}));
  EXPECT_NE(again.err.find("all 4 frames are there"), std::string::npos) << again.err;

  becalm_done({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "draft.exr", "--preset", "draft"});
  expect_error(becalm({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "draft.exr", "--preset", "draft",
                       "--segment", "8", "--resume"}),
               2, {"draft.exr", "no segment, and this run has segment=8"});
  expect_error(becalm(command("a.####.exr", {"--resume", "--reproducible", "--device", "llvmpipe"})), 2,
               {"reproducible"});
  expect_error(becalm(command("a.####.exr", {"--resume", "--set", "patch_radius=5"})), 2,
               {"a.0001.exr", "patch_radius=5"});
  // The same frames are read for them, and the same pixels come out.
  becalm_done(command("a.####.exr", {"--resume", "--frames", "2-4"}));
  expect_error(becalm(command("a.####.exr", {"--resume", "--frames", "2-4", "--context", "none"})), 2,
               {"a.0002.exr", "context=none"});
}

TEST_F(Denoise, ResumeRefusesOtherOptionsAndNamesThem) {
  io::write_exr(frame_path(input_, 1), noise_frame(1, 16, 16), {}, io::PixelType::float32);
  becalm_done(command("a.####.exr", {"--quiet"}));
  using Words = std::vector<std::string>;
  for (const auto& [options, told] : {std::pair{Words{"--diagnostics"}, "diagnostics=yes"},
                                      {Words{"--alpha", "denoise"}, "alpha=denoise"},
                                      {Words{"--additive", "none"}, "additive=no"},
                                      {Words{"--cuts", "3"}, "cuts=3"},
                                      {Words{"--only", "beauty"}, "only=beauty"},
                                      {Words{"--channels", "beauty,albedo"}, "channels=beauty,albedo"},
                                      {Words{"--type", "half"}, "type=half"},
                                      {Words{"--compression", "piz"}, "compression=piz"},
                                      {Words{"--no-halves"}, "halves=no"},
                                      {Words{"--no-stereo"}, "stereo=no"},
                                      {Words{"--warmup", "4"}, "warmup=4"}}) {
    Words more{"--resume"};
    more.insert(more.end(), options.begin(), options.end());
    expect_error(becalm(command("a.####.exr", more)), 2, {"a.0001.exr", told});
  }
}

TEST_F(Denoise, ResumeMakesAgainWhatWasMadeFromOtherFrames) {
  write_frames({1, 2, 3, 4});
  const std::vector<std::string> options{"--segment", "2", "--warmup", "0", "--resume", "--frames", "1-4"};
  const std::string out = folder_ / "a.####.exr";
  const auto times = [&] {
    std::vector<fs::file_time_type> times;
    for (const int frame : {1, 2, 3, 4}) times.push_back(fs::last_write_time(frame_path(out, frame)));
    return times;
  };
  becalm_done(command("a.####.exr", options));
  EXPECT_EQ(io::read_attribute(frame_path(out, 3), "becalm:inputs").substr(0, 4), "2,3 ");
  EXPECT_EQ(io::read_attribute(frame_path(out, 3), "becalm:layers"),
            "beauty=R,G,B,A albedo=albedo.R,albedo.G,albedo.B normal=normal.X,normal.Y,normal.Z");
  const auto before = times();

  fs::last_write_time(frame_path(input_, 1), fs::file_time_type::clock::now());
  becalm_done(command("a.####.exr", options));
  EXPECT_EQ(times(), before) << "the content counts, not the time";

  io::write_exr(frame_path(input_, 3), noise_frame(33), {}, io::PixelType::float32);
  const Outcome changed = becalm_done(command("a.####.exr", options));
  EXPECT_NE(changed.err.find("2 frames are made again"), std::string::npos) << changed.err;
  EXPECT_NE(changed.err.find("have changed: 2,3\n"), std::string::npos) << changed.err;
  const auto after = times();
  for (const std::size_t kept : {0, 3}) EXPECT_EQ(after[kept], before[kept]);
  becalm_done(command("fresh.####.exr", options));
  expect_same_beauty(folder_ / "fresh.####.exr", out, 1, 4);

  io::write_exr(frame_path(input_, 5), noise_frame(5), {}, io::PixelType::float32);
  const Outcome neighbour = becalm_done(command("a.####.exr", options));
  EXPECT_NE(neighbour.err.find("1 frame is made again"), std::string::npos) << neighbour.err;
  EXPECT_NE(neighbour.err.find("1 frame written"), std::string::npos) << neighbour.err;

  for (const int frame : {1, 2, 3, 4, 5}) {
    io::write_exr(frame_path(input_, frame), noise_frame(frame, 40, 24), {{"becalm:settings", "spp=9"}});
  }
  const Outcome other_shot = becalm_done(command("a.####.exr", options));
  EXPECT_NE(other_shot.err.find("4 frames are made again"), std::string::npos) << other_shot.err;
  for (const int frame : {1, 2, 3, 4}) EXPECT_EQ(read_frame(frame_path(out, frame)).width(), 40);
}

TEST_F(Denoise, ResumeMakesAgainWhatHasOtherFramesBesideItWithoutContext) {
  write_frames({1, 2});
  const std::vector<std::string> options{"--context", "none", "--resume"};
  becalm_done(command("a.####.exr", options));
  write_frames({3});
  const Outcome outcome = becalm_done(command("a.####.exr", options));
  EXPECT_NE(outcome.err.find("2 frames are made again"), std::string::npos) << outcome.err;
  becalm_done(command("fresh.####.exr"));
  expect_same_beauty(folder_ / "fresh.####.exr", folder_ / "a.####.exr", 1, 3);
}

TEST_F(Denoise, ResumeMakesAgainWhatShowsAnotherFrame) {
  write_frames({1, 2, 3});
  becalm_done(command("a.####.exr"));
  becalm_done(command("whole.####.exr"));
  fs::copy_file(folder_ / "a.0002.exr", folder_ / "a.0003.exr", fs::copy_options::overwrite_existing);
  const Outcome outcome = becalm_done(command("a.####.exr", {"--resume"}));
  EXPECT_NE(outcome.err.find("1 frame is made again"), std::string::npos) << outcome.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 3);
}

TEST_F(Denoise, AForwardFilterResumesToTheSamePixels) {
  write_frames({1, 2, 3, 4});
  const std::vector<std::string> draft{"--preset", "draft"};
  becalm_done(command("whole.####.exr", draft));
  becalm_done(command("a.####.exr", draft));
  fs::remove(folder_ / "a.0003.exr");
  const Outcome outcome = becalm_done(command("a.####.exr", {"--preset", "draft", "--resume"}));
  EXPECT_NE(outcome.err.find("frame 2: exists"), std::string::npos) << outcome.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 4);
  // The history would begin elsewhere, and other pixels would come out.
  expect_error(becalm(command("a.####.exr", {"--preset", "draft", "--resume", "--frames", "2-4"})), 2,
               {"a.0002.exr", "first_frame=2"});
}

TEST_F(Denoise, FilesThatBecalmDidNotWriteAreNotReplacedUnlessAsked) {
  write_frames({1});
  io::write_exr(folder_ / "out.0001.exr", noise_frame(9), {});
  expect_error(becalm(command("out.####.exr")), 2, {"out.0001.exr", "--overwrite"});
  EXPECT_EQ(io::read_attribute(folder_ / "out.0001.exr", "becalm:version"), "");
  becalm_done(command("out.####.exr", {"--overwrite", "--quiet"}));
  becalm_done(command("out.####.exr", {"-q"}));
}

TEST_F(Denoise, RenderedFramesAreNotReplacedUnlessAsked) {
  write_frames({1});
  io::write_exr(folder_ / "out.0001.exr", noise_frame(9), {{"becalm:version", "1"}});
  expect_error(becalm(command("out.####.exr")), 2,
               {"out.0001.exr", "becalm denoise did not write it", "--overwrite"});
  fs::create_directories(folder_ / "folder.0001.exr");
  expect_error(becalm(command("folder.####.exr", {"--dry-run"})), 4, {"folder.0001.exr"});
}

TEST_F(Denoise, CommandsDoNotReplaceEachOthersFilesUnlessAsked) {
  io::write_exr(frame_path(input_, 1), noise_frame(1, 16, 16), {});
  const std::string denoised = folder_ / "d.####.exr";
  const std::string antialiased = folder_ / "a.####.exr";
  const std::vector<std::string> antialias{"antialias", input_, "-o"};
  const auto with = [](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  becalm_done(command("d.####.exr", {"-q"}));
  becalm_done(with(antialias, {antialiased, "-q"}));
  EXPECT_EQ(io::read_attribute(folder_ / "a.0001.exr", "becalm:command"), "antialias");
  const std::vector<std::string> render{"render", write_scene(folder_), "--frames", "1", "-o"};
  const std::vector<std::string> noisy =
      with(render, {folder_ / "r.####.exr", "--denoise=draft", "--context", "none", "--keep-noisy"});
  for (const auto& [arguments, told] :
       {std::pair{command("a.####.exr"), "-o " + folder_ / "a.0001.exr: is there, and becalm denoise did"},
        {command("a.####.exr", {"--resume"}), "becalm denoise did not write it"},
        {with(antialias, {denoised}), "becalm antialias did not write it"},
        {with(render, {denoised}), "becalm render did not write it"},
        {with(noisy, {denoised}), "becalm render --keep-noisy did not write it"}}) {
    expect_error(becalm(arguments), 2, {told, "--overwrite replaces it"});
  }
  becalm_done(command("a.####.exr", {"-q", "--overwrite"}));
}

TEST_F(Denoise, FilesOfEarlierVersionsAreKnownByWhatTheyRecord) {
  io::write_exr(frame_path(input_, 1), noise_frame(1, 16, 16), {});
  becalm_done(command("out.####.exr", {"-q"}));
  const std::string path = folder_ / "out.0001.exr";
  io::Attributes recorded;
  for (const char* name : {"version", "settings", "preset", "additive", "inputs"}) {
    const std::string attribute = "becalm:" + std::string(name);
    recorded.emplace_back(attribute, io::read_attribute(path, attribute));
  }
  io::write_exr(path, noise_frame(1, 16, 16), recorded);
  EXPECT_NE(becalm_done(command("out.####.exr", {"--resume"})).err.find("the frame is there already"),
            std::string::npos);
  becalm_done(command("out.####.exr", {"-q"}));
  EXPECT_EQ(io::read_attribute(path, "becalm:command"), "denoise");
}

TEST_F(Denoise, NumbersMayHaveLeadingZeros) {
  write_frames({1});
  becalm_done(
      {"denoise", frame_path(input_, 1), "--frame", "0012", "-o", folder_ / "a.####.exr", "--threads", "01"});
  EXPECT_TRUE(fs::exists(folder_ / "a.0012.exr"));
  becalm_done({"denoise", frame_path(input_, 1), "--frame", "0009", "-o", folder_ / "a.####.exr"});
  EXPECT_TRUE(fs::exists(folder_ / "a.0009.exr"));
}

TEST_F(Denoise, ResumeReplacesNoFileThatBecalmDidNotWrite) {
  write_frames({1});
  write_text(folder_ / "out.0001.exr", "not an image");
  expect_error(becalm(command("out.####.exr", {"--resume"})), 2, {"out.0001.exr", "--overwrite"});
  write_text(folder_ / "out.0001.exr", "");
  becalm_done(command("out.####.exr", {"--resume", "--quiet"}));
}

TEST_F(Denoise, ResumeKeepsOutputsWhoseLayersBecalmDoesNotKnow) {
  write_frames({1});
  const std::vector<std::string> depth{"--channels", "albedo", "--resume"};
  becalm_done(command("out.####.exr", depth));
  const auto written = fs::last_write_time(folder_ / "out.0001.exr");
  const Outcome again = becalm_done(command("out.####.exr", depth));
  EXPECT_EQ(again.err.find("damaged"), std::string::npos) << again.err;
  EXPECT_EQ(fs::last_write_time(folder_ / "out.0001.exr"), written);
}

}  // namespace
}  // namespace becalm::test
