// becalm antialias: from the tracer's jittered frames to files, resumed, and what it refuses.

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "frame/io/jitter_text.h"
#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

/// The harness's scene with jitter and a hard sun instead of noisy light.
std::string write_jittered_scene(const TempFolder& folder, const std::string& more = "") {
  const std::string path = write_scene(folder);
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string scene = text.str();
  const std::string film = "\"film\": {";
  scene.insert(scene.find(film) + film.size(), "\"jitter_cycle\": 4, " + more);
  write_text(path, scene);
  return path;
}

/// A beauty of 8x8 pixels beside a deep part without samples.
void write_with_deep_part(const std::string& path) {
  Imf::Header flat(8, 8);
  flat.setName("flat");
  flat.setType(Imf::SCANLINEIMAGE);
  Imf::Header deep(8, 8);
  deep.setName("deep");
  deep.setType(Imf::DEEPSCANLINE);
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  std::vector<float> plane(64, 0.5f);
  Imf::FrameBuffer pixels;
  for (const char* name : {"R", "G", "B"}) {
    flat.channels().insert(name, Imf::Channel(Imf::FLOAT));
    pixels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()), 4, 32));
  }
  std::vector<unsigned> counts(64, 0);
  std::vector<float*> samples(64, nullptr);
  Imf::DeepFrameBuffer deep_pixels;
  deep_pixels.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), 8 * sizeof(unsigned)));
  deep_pixels.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()), sizeof(float*),
                                         8 * sizeof(float*), sizeof(float)));
  const Imf::Header headers[] = {flat, deep};
  Imf::MultiPartOutputFile file(path.c_str(), headers, 2);
  Imf::OutputPart flat_part(file, 0);
  flat_part.setFrameBuffer(pixels);
  flat_part.writePixels(8);
  Imf::DeepScanLineOutputPart deep_part(file, 1);
  deep_part.setFrameBuffer(deep_pixels);
  deep_part.writePixels(8);
}

class Antialias : public testing::Test {
 protected:
  void render(const std::string& spp = "1") const {
    becalm_done({"render", write_jittered_scene(folder_), "-o", input_, "--spp", spp, "--float", "--aovs",
                 "motion,depth", "--quiet"});
  }
  std::vector<std::string> command(const std::string& pattern,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"antialias", input_, "-o", folder_ / pattern};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  TempFolder folder_;
  std::string input_ = folder_ / "in.####.exr";
};

TEST_F(Antialias, AveragesTheTracersJitteredFrames) {
  render();
  const Frame first = read_frame(frame_path(input_, 1));
  ASSERT_TRUE(first.jitter());
  ASSERT_EQ(first.jitter()->positions_px.size(), 1u);
  EXPECT_NEAR(first.jitter()->positions_px[0].x, 0.0f, 1e-6f) << "Halton's first point in base 2 is 1/2";
  EXPECT_LT(first.jitter()->positions_px[0].y, 0.0f);
  const Outcome outcome = becalm_done(command("out.####.exr", {"--diagnostics"}));
  EXPECT_NE(outcome.err.find("motion vectors where known, else by the search"), std::string::npos)
      << outcome.err;
  for (int number = 1; number <= 4; ++number) {
    const std::string path = frame_path(folder_ / "out.####.exr", number);
    AovSet aovs;
    aovs.set(static_cast<std::size_t>(Aov::motion)).set(static_cast<std::size_t>(Aov::sample_count));
    const Frame result = read_frame(path, aovs);
    EXPECT_FALSE(result.jitter()) << "is averaged";
    EXPECT_EQ(io::read_attribute(path, "becalm:preset"), "best");
    EXPECT_TRUE(same_pixels(result.image(Aov::motion),
                            read_frame(frame_path(input_, number), aovs).image(Aov::motion)));
    EXPECT_FALSE(
        same_pixels(result.image(Aov::beauty), read_frame(frame_path(input_, number)).image(Aov::beauty)));
  }
}

TEST_F(Antialias, ADeepPartIsNotScaledAndThatIsToldAtOnce) {
  write_with_deep_part(frame_path(input_, 1));
  expect_error(becalm(command("out/a.####.exr", {"--scale", "2", "--dry-run"})), 3,
               {frame_path(input_, 1), "has a deep part", "--channels"});
  becalm_done(command("out/a.####.exr", {"--scale", "2", "--channels", "beauty", "--quiet"}));
  EXPECT_EQ(read_frame(folder_ / "out/a.0001.exr").width(), 16);
  becalm_done(command("whole.####.exr", {"--channels", "deep,beauty", "--quiet"}));
}

TEST_F(Antialias, FeaturesOfJitteredFramesHaveTheBeautysSamples) {
  const std::string scene = write_jittered_scene(folder_);
  const auto normal = [&](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", scene, "-o",     folder_ / file, "--frames", "1",
                                       "--spp",  "1",   "--aovs", "normal",       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    becalm_done(arguments);
    return read_frame(folder_ / file, AovSet().set()).image(Aov::normal);
  };
  EXPECT_TRUE(same_pixels(normal("a.exr", {}), normal("b.exr", {"--aov-spp", "1"})));
}

TEST_F(Antialias, ResumesToTheSamePixels) {
  render();
  becalm_done(command("whole.####.exr", {"--quiet"}));
  becalm_done(command("a.####.exr", {"--quiet"}));
  fs::remove(folder_ / "a.0002.exr");
  becalm_done(command("a.####.exr", {"--resume"}));
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 4);
  expect_error(becalm(command("a.####.exr", {"--resume", "--set", "mask=yes"})), 2, {"a.0001.exr", "mask"});
  expect_error(becalm(command("a.####.exr", {"--resume", "--jitter", "none"})), 2, {"a.0001.exr", "jitter"});
}

TEST_F(Antialias, TakesWhatTheUserSaysOfTheJitter) {
  render("2");
  EXPECT_EQ(read_frame(frame_path(input_, 1)).jitter()->positions_px.size(), 2u);
  becalm_done(command("given.####.exr", {"--jitter", "halton:8", "--preset", "forward", "--quiet"}));
  becalm_done(command("none.####.exr", {"--jitter", "none", "--preset", "forward", "--quiet"}));
  EXPECT_FALSE(same_pixels(read_frame(frame_path(folder_ / "given.####.exr", 2)).image(Aov::beauty),
                           read_frame(frame_path(folder_ / "none.####.exr", 2)).image(Aov::beauty)));
}

TEST_F(Antialias, ScalesTheBeautyAndEveryOtherChannel) {
  render();
  const Frame given = read_frame(frame_path(input_, 2), AovSet().set());
  becalm_done(command("out.####.exr", {"--scale", "3/2", "--quiet"}));
  const Frame result = read_frame(frame_path(folder_ / "out.####.exr", 2), AovSet().set());
  EXPECT_EQ(result.width(), Scale({3, 2}).edge(given.width()));
  EXPECT_EQ(result.height(), Scale({3, 2}).edge(given.height()));
  EXPECT_FALSE(result.jitter());
  NearestSample nearest{.scale = {3, 2}, .window = {{0, 0}, {given.width() - 1, given.height() - 1}}};
  nearest.position_px = given.jitter()->positions_px.front();
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      const Imath::V2i at = nearest.at(x, y);
      ASSERT_EQ(result.image(Aov::depth).at(x, y, 0), given.image(Aov::depth).at(at.x, at.y, 0));
      ASSERT_EQ(result.image(Aov::motion).at(x, y, 0), 1.5f * given.image(Aov::motion).at(at.x, at.y, 0));
    }
  }
  becalm_done(command("a.####.exr", {"--scale", "1.5", "--quiet"}));
  fs::remove(folder_ / "a.0002.exr");
  becalm_done(command("a.####.exr", {"--scale", "1.5", "--resume"}));
  expect_same_beauty(folder_ / "out.####.exr", folder_ / "a.####.exr", 1, 4);
  expect_error(becalm(command("a.####.exr", {"--scale", "2", "--resume"})), 2, {"a.0001.exr", "scale"});
}

TEST_F(Antialias, MakesCheckerboardsWhole) {
  const std::string scene = write_jittered_scene(folder_);
  becalm_done({"render", scene, "-o", input_, "--spp", "1", "--float", "--aovs", "motion,depth",
               "--checkerboard", "--quiet"});
  const Frame given = read_frame(frame_path(input_, 1));
  ASSERT_EQ(given.checkerboard(), Parity::odd) << "frame 1 has an odd number";
  for (int y = 0; y < given.height(); ++y) {
    for (int x = 0; x < given.width(); ++x) {
      const bool holds = has_sample(Parity::odd, x, y);
      ASSERT_TRUE(holds || given.image(Aov::beauty).at(x, y, 1) == 0.0f);
    }
  }
  becalm_done(command("auto.####.exr", {"--checkerboard", "--quiet"}));
  becalm_done(command("even.####.exr", {"--checkerboard=even", "--quiet"}));
  expect_same_beauty(folder_ / "auto.####.exr", folder_ / "even.####.exr", 1, 4);
  expect_error(becalm(command("odd.####.exr", {"--checkerboard=odd"})), 3,
               {"in.000", "becalm:checkerboard", "--checkerboard=odd"});
  EXPECT_FALSE(fs::exists(frame_path(folder_ / "odd.####.exr", 1)));
  expect_error(becalm(command("odd.####.exr", {"--checkerboard", "odd"})), 2, {"--checkerboard=odd"});
  AovSet depth;
  depth.set(static_cast<std::size_t>(Aov::depth));
  const Frame whole = read_frame(frame_path(folder_ / "auto.####.exr", 1), depth);
  EXPECT_FALSE(whole.checkerboard());
  const std::string holes = "frames 1-4: a checkerboard of pixels";
  expect_error(becalm(command("out.####.exr")), 3, {"in.####.exr", holes, "antialias --checkerboard"});
  expect_error(becalm({"denoise", input_, "-o", folder_ / "out.####.exr"}), 3, {"in.####.exr", holes});
  fs::copy_file(frame_path(folder_ / "auto.####.exr", 3), frame_path(input_, 3),
                fs::copy_options::overwrite_existing);
  expect_error(becalm(command("out.####.exr", {"--checkerboard"})), 3,
               {"in.0003.exr", "becalm:checkerboard", "--checkerboard=even"});
  EXPECT_FALSE(fs::exists(frame_path(folder_ / "out.####.exr", 1))) << "headers are read before any pixel";
  expect_error(becalm(command("out.####.exr", {"--checkerboard=both"})), 2, {"--checkerboard=both", "even"});
  expect_error(becalm({"render", scene, "-o", folder_ / "r.####.exr", "--checkerboard", "--denoise"}), 2,
               {"--checkerboard"});
}

TEST_F(Antialias, AFrameOfOnePlaceTellsIt) {
  becalm_done({"render", write_jittered_scene(folder_, "\"jitter_one_a_frame\": true, "), "-o", input_,
               "--spp", "4", "--aovs", "motion,depth,variance", "--quiet"});
  for (int number = 1; number <= 2; ++number) {
    ASSERT_EQ(read_frame(frame_path(input_, number)).jitter()->positions_px.size(), 1u);
  }
  EXPECT_NE(read_frame(frame_path(input_, 1)).jitter(), read_frame(frame_path(input_, 2)).jitter());
  // The recipe for noise at the same time: the place survives denoising.
  const std::string denoised = folder_ / "denoised.####.exr";
  becalm_done({"denoise", input_, "-o", denoised, "--preset", "draft", "--quiet"});
  EXPECT_EQ(read_frame(frame_path(denoised, 2)).jitter(), read_frame(frame_path(input_, 2)).jitter());
  becalm_done({"antialias", denoised, "-o", folder_ / "out.####.exr", "--scale", "2", "--quiet"});
  EXPECT_EQ(read_frame(frame_path(folder_ / "out.####.exr", 2)).width(),
            2 * read_frame(frame_path(input_, 2)).width());
}

TEST_F(Antialias, RefusesWhatIsWrong) {
  expect_error(becalm(command("out.####.exr")), 3, {"in.####.exr"});
  render();
  expect_error(becalm(command("out.####.exr", {"--jitter", "halton:0"})), 2, {"--jitter halton:0"});
  for (const char* scale : {"0.5", "5", "2x", "-2", "3/0", "1.2345", "", "nan", "4001/1000"}) {
    expect_error(becalm(command("out.####.exr", {"--scale", scale})), 2, {"--scale"});
  }
  expect_error(becalm(command("out.####.exr", {"--checkerboard"})), 3, {"becalm:checkerboard"});
  expect_error(becalm(command("out.####.exr", {"--preset", "balanced"})), 2,
               {"preset 'balanced'", "best", "paper"});
  expect_error(becalm(command("out.####.exr", {"--set", "refine_levels=13"})), 2, {"refine_levels", "0..12"});
  expect_error(becalm(command("out.####.exr", {"--memory", "64K"})), 4, {"whole frames of"});
  expect_error(becalm({"antialias", input_, "-o", input_}), 2, {"would overwrite the input"});
  std::ofstream(frame_path(input_, 2)) << "no image";
  expect_error(becalm(command("out.####.exr")), 3, {"in.0002.exr"});
}

TEST_F(Antialias, HelpFitsAScreen) {
  const Outcome help = becalm_done({"antialias", "--help"});
  EXPECT_LE(std::ranges::count(help.out, '\n'), 60);
  const Outcome settings = becalm_done({"antialias", "--help-settings"});
  EXPECT_NE(settings.out.find("reproject"), std::string::npos);
}

TEST(JitterText, IsReadAsItIsWritten) {
  const FrameJitter jitter{
      .positions_px = {{0.25f, -0.125f}, {-1.0f, 0.5f}}, .filter = FilterShape::tent, .radius_px = 1.0f};
  EXPECT_EQ(io::format_jitter(jitter), "tent 1: 0.25 -0.125, -1 0.5");
  EXPECT_EQ(io::parse_jitter(io::format_jitter(jitter)), jitter);
  for (const char* text :
       {"", "none", "tent 1", "tent 1:", "tent 1: 0.1", "round 1: 0 0", "box 1: 0 nan", "box 1: 0 0,"}) {
    EXPECT_FALSE(io::parse_jitter(text)) << text;
  }
}

}  // namespace
}  // namespace becalm::test
