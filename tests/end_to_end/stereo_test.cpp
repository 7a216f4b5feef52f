// Both eyes, from the tracer to files and through becalm denoise: views of one file, and a file for each eye.

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "frame/io/stereo_text.h"
#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

AovSet stereo_weight() {
  return AovSet().set(static_cast<std::size_t>(Aov::stereo_weight));
}

/// The harness's scene with two eyes.
std::string write_stereo_scene(const TempFolder& folder) {
  const std::string path = write_scene(folder);
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string scene = text.str();
  const std::string camera = "\"camera\": {";
  scene.insert(scene.find(camera) + camera.size(), "\"eye_separation\": 0.3, ");
  write_text(path, scene);
  return path;
}

/// Copies what lies within `window`, which becomes the data window, without the attribute of the camera if
/// `bare`.
void crop(const std::string& from, const std::string& to, const Imath::Box2i& window, bool bare) {
  Imf::InputFile file(from.c_str());
  Imf::Header header = file.header();
  const int width = header.dataWindow().max.x + 1;
  const int height = header.dataWindow().max.y + 1;
  header.dataWindow() = window;
  if (bare) header.erase(io::kStereoAttribute);
  Imf::FrameBuffer buffer;
  std::map<std::string, std::vector<float>> planes;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    channel.channel().type = Imf::FLOAT;
    std::vector<float>& plane = planes[channel.name()];
    plane.resize(static_cast<std::size_t>(width) * height);
    buffer.insert(channel.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()), sizeof(float),
                                             sizeof(float) * width));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(0, height - 1);
  Imf::OutputFile cropped(to.c_str(), header);
  cropped.setFrameBuffer(buffer);
  cropped.writePixels(window.max.y - window.min.y + 1);
}

class Stereo : public testing::Test {
 protected:
  /// Files with both eyes as views, in.####.exr, and files of each eye, in.left.####.exr and
  /// in.right.####.exr.
  void render() const {
    const std::string scene = write_stereo_scene(folder_);
    for (const char* name : {"in.####.exr", "in.%V.####.exr"}) {
      becalm_done({"render", scene, "-o", folder_ / name, "--spp", "2", "--float", "--aovs",
                   "albedo,normal,depth,motion,variance", "--quiet"});
    }
  }
  std::vector<std::string> command(const std::string& input, const std::string& output,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"denoise",        folder_ / input, "-o",
                                       folder_ / output, "--preset",      "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static std::array<Image, 2> eyes_of(const std::string& path) {
    const io::LoadedFrame loaded = io::read_exr(path, 0, {});
    EXPECT_EQ(loaded.other_views.size(), 1u) << path;
    return {loaded.frame.image(Aov::beauty), loaded.other_views.at(0).frame.image(Aov::beauty)};
  }
  Image beauty(const std::string& pattern, int number) const {
    return read_frame(frame_path(folder_ / pattern, number)).image(Aov::beauty);
  }

  TempFolder folder_;
};

TEST_F(Stereo, TheTracerWritesViewsOrAFileForEachEye) {
  render();
  const std::string path = frame_path(folder_ / "in.####.exr", 2);
  const io::LoadedFrame both = io::read_exr(path, 2, all_aovs());
  EXPECT_EQ(both.view, "left");
  ASSERT_EQ(both.other_views.size(), 1u);
  EXPECT_EQ(both.other_views[0].view, "right");
  ASSERT_TRUE(both.frame.stereo() && both.other_views[0].frame.stereo());
  EXPECT_EQ(both.other_views[0].frame.stereo()->eye, Eye::right);
  EXPECT_NEAR(both.frame.stereo()->camera.separation, 0.3, 1e-9);
  EXPECT_TRUE(both.other_views[0].frame.has(Aov::motion));
  EXPECT_TRUE(same_pixels(both.frame.image(Aov::beauty), beauty("in.left.####.exr", 2)));
  EXPECT_TRUE(same_pixels(both.other_views[0].frame.image(Aov::beauty), beauty("in.right.####.exr", 2)));
  const std::string scene = folder_ / "scene.json";
  becalm_done({"render", scene, "-o", folder_ / "r.####.exr", "--frames", "2", "--spp", "2", "--float",
               "--eye", "right", "--quiet"});
  EXPECT_TRUE(same_pixels(beauty("r.####.exr", 2), beauty("in.right.####.exr", 2)));
}

TEST_F(Stereo, EyesAreFilteredTogetherHoweverTheyAreGiven) {
  render();
  const Outcome outcome = becalm_done(command("in.####.exr", "v.####.exr", {"--diagnostics"}));
  EXPECT_NE(outcome.err.find("the eyes are filtered together"), std::string::npos) << outcome.err;
  EXPECT_TRUE(read_frame(frame_path(folder_ / "v.####.exr", 1), stereo_weight()).has(Aov::stereo_weight));
  becalm_done(command("in.%V.####.exr", "f.%V.####.exr", {"--diagnostics", "--quiet"}));
  becalm_done({"denoise", "--stereo", folder_ / "in.left.####.exr", folder_ / "in.right.####.exr", "-o",
               folder_ / "g.%v.####.exr", "--preset", "draft", "--diagnostics", "--quiet"});
  becalm_done(command("in.####.exr", "alone.####.exr", {"--no-stereo", "--quiet"}));
  becalm_done(command("in.left.####.exr", "mono.####.exr", {"--quiet"}));
  for (int number = 1; number <= 4; ++number) {
    const auto [left, right] = eyes_of(frame_path(folder_ / "v.####.exr", number));
    EXPECT_TRUE(same_pixels(left, beauty("f.left.####.exr", number)));
    EXPECT_TRUE(same_pixels(right, beauty("f.right.####.exr", number)));
    EXPECT_TRUE(same_pixels(left, beauty("g.l.####.exr", number)));
    EXPECT_TRUE(same_pixels(right, beauty("g.r.####.exr", number)));
    const auto alone = eyes_of(frame_path(folder_ / "alone.####.exr", number));
    EXPECT_TRUE(same_pixels(alone[0], beauty("mono.####.exr", number))) << "each view by itself";
    EXPECT_FALSE(same_pixels(alone[0], left));
  }
}

TEST_F(Stereo, AovsOfOneEyeAloneAreToldAndNotUsed) {
  render();
  const std::string scene = folder_ / "scene.json";
  becalm_done({"render", scene, "-o", folder_ / "bare.%V.####.exr", "--spp", "2", "--float", "--quiet"});
  for (int number = 1; number <= 4; ++number) {
    const auto of_right = [&](const char* name) { return frame_path(folder_ / name, number); };
    fs::copy_file(of_right("bare.right.####.exr"), of_right("in.right.####.exr"),
                  fs::copy_options::overwrite_existing);
  }
  const Outcome outcome = becalm_done(command("in.%V.####.exr", "f.%V.####.exr"));
  EXPECT_NE(outcome.err.find("; not used, since one eye alone has them: "), std::string::npos) << outcome.err;
  becalm_done(command("bare.%V.####.exr", "g.%V.####.exr", {"--quiet"}));
  EXPECT_TRUE(same_pixels(beauty("f.left.####.exr", 3), beauty("g.left.####.exr", 3)));
}

TEST_F(Stereo, RenderAndDenoiseAgree) {
  render();
  const std::string scene = folder_ / "scene.json";
  for (const char* name : {"d.####.exr", "d.%V.####.exr"}) {
    becalm_done(
        {"render", scene, "-o", folder_ / name, "--spp", "2", "--float", "--denoise=balanced", "--quiet"});
  }
  for (int number = 1; number <= 4; ++number) {
    const auto [left, right] = eyes_of(frame_path(folder_ / "d.####.exr", number));
    EXPECT_TRUE(same_pixels(left, beauty("d.left.####.exr", number)));
    EXPECT_TRUE(same_pixels(right, beauty("d.right.####.exr", number)));
  }
  EXPECT_TRUE(std::ranges::none_of(files_in(folder_.path()), [](const std::string& name) {
    return name.find("noisy") != std::string::npos;
  }));
}

TEST_F(Stereo, ResultsDoNotDependOnHowTheJobIsCut) {
  render();
  const std::vector<std::string> segments{"--preset", "balanced", "--segment", "2",
                                          "--warmup", "1",        "--quiet"};
  const auto run = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"denoise", folder_ / "in.%V.####.exr", "-o", folder_ / output};
    arguments.insert(arguments.end(), segments.begin(), segments.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return becalm_done(arguments);
  };
  run("whole.%V.####.exr", {});
  run("cut.%V.####.exr", {"--frames", "3"});
  run("cut.%V.####.exr", {"--frames", "1-2,4"});
  fs::remove(folder_ / "cut.right.0002.exr");
  run("cut.%V.####.exr", {"--resume"});
  for (const char* eye : {"left", "right"}) {
    expect_same_beauty(folder_ / ("whole." + std::string(eye) + ".####.exr"),
                       folder_ / ("cut." + std::string(eye) + ".####.exr"), 1, 4);
  }
  expect_error(becalm(command("in.####.exr", "whole.left.####.exr", {"--resume"})), 2,
               {"whole.left.0001.exr"});
}

TEST_F(Stereo, TakesTheCamerasFromTheUserOrSearches) {
  render();
  const io::LoadedFrame loaded = io::read_exr(frame_path(folder_ / "in.####.exr", 1), 1, {});
  const StereoCamera& camera = loaded.frame.stereo()->camera;
  for (int number = 1; number <= 4; ++number) {
    for (const char* eye : {"left", "right"}) {
      Frame frame = read_frame(frame_path(folder_ / fmt::format("in.{}.####.exr", eye), number), all_aovs());
      frame.set_stereo(std::nullopt);
      io::write_exr(frame_path(folder_ / fmt::format("bare.{}.####.exr", eye), number), frame, {},
                    io::PixelType::float32);
    }
  }
  becalm_done(command("in.%V.####.exr", "known.%V.####.exr", {"--quiet"}));
  becalm_done(command("bare.%V.####.exr", "searched.%V.####.exr", {"--quiet"}));
  becalm_done(command("bare.%V.####.exr", "given.%V.####.exr",
                      {"--quiet", "--stereo-camera",
                       fmt::format("{},{},{}", camera.focal_px, camera.separation, camera.convergence)}));
  expect_same_beauty(folder_ / "known.left.####.exr", folder_ / "given.left.####.exr", 1, 4);
  expect_same_beauty(folder_ / "known.right.####.exr", folder_ / "given.right.####.exr", 1, 4);
  EXPECT_FALSE(same_pixels(beauty("known.left.####.exr", 2), beauty("searched.left.####.exr", 2)));
  for (const char* wrong :
       {"1200", "1200,0.1", "1200,0.1,0", "1200,0.1,2,flat", "1200,0.1,nan", "1200,0.1,2,"}) {
    expect_error(becalm(command("in.%V.####.exr", "x.%V.####.exr", {"--stereo-camera", wrong})), 2,
                 {"--stereo-camera", wrong, "FOCAL_PX"});
  }
  expect_error(becalm(command("in.left.####.exr", "x.####.exr", {"--stereo-camera", "1200,0.1,2"})), 2,
               {"--stereo-camera 1200,0.1,2", "1 view"});
}

TEST_F(Stereo, CamerasFromTheUserAreOfTheWholePicture) {
  render();
  const StereoCamera camera = read_frame(frame_path(folder_ / "in.left.####.exr", 1)).stereo()->camera;
  const Imath::Box2i window(Imath::V2i(14, 0), Imath::V2i(45, 22));
  for (int number = 1; number <= 2; ++number) {
    for (const std::string eye : {"left.####.exr", "right.####.exr"}) {
      const auto path = [&](const char* name) { return frame_path(folder_ / (name + eye), number); };
      crop(path("in."), path("crop."), window, false);
      crop(path("in."), path("bare."), window, true);
    }
  }
  std::vector<std::string> options{"--quiet", "--set", "smooth=none"};
  becalm_done(command("crop.%V.####.exr", "known.%V.####.exr", options));
  options.insert(options.end(), {"--stereo-camera", fmt::format("{},{},{}", camera.focal_px,
                                                                camera.separation, camera.convergence)});
  becalm_done(command("bare.%V.####.exr", "given.%V.####.exr", options));
  expect_same_beauty(folder_ / "known.left.####.exr", folder_ / "given.left.####.exr", 1, 2);
  expect_same_beauty(folder_ / "known.right.####.exr", folder_ / "given.right.####.exr", 1, 2);
}

TEST_F(Stereo, RefusesWhatIsWrong) {
  render();
  expect_error(becalm(command("in.%V.####.exr", "out.####.exr")), 2, {"-o", "%V"});
  expect_error(becalm(command("in.####.exr", "out.%V.####.exr")), 2, {"-o", "field for the eye"});
  expect_error(becalm(command("in.left.####.exr", "out.####.exr", {"--stereo"})), 3,
               {"--stereo", "two views"});
  expect_error(becalm({"denoise", "--stereo", folder_ / "in.right.####.exr", folder_ / "in.left.####.exr",
                       "-o", folder_ / "out.%V.####.exr"}),
               3, {"in.right.000", "is of the right eye"});
  expect_error(becalm({"render", write_scene(folder_), "-o", folder_ / "out.%V.####.exr"}), 2,
               {"-o", "eye_separation"});
  expect_error(becalm({"render", write_scene(folder_), "-o", folder_ / "out.####.exr", "--eye", "left"}), 2,
               {"--eye left", "eye_separation"});
  fs::remove(folder_ / "in.right.0003.exr");
  expect_error(becalm(command("in.%V.####.exr", "out.%V.####.exr")), 3, {"in.right.####.exr", "frame 3"});
  const Outcome skipped =
      becalm_done(command("in.%V.####.exr", "out.%V.####.exr", {"--missing", "skip", "--quiet"}));
  EXPECT_NE(skipped.err.find("frame 3 is not on disk in both and is left out"), std::string::npos)
      << skipped.err;
  EXPECT_FALSE(fs::exists(folder_ / "out.left.0003.exr"));
  EXPECT_TRUE(fs::exists(folder_ / "out.right.0004.exr"));
  io::write_exr(folder_ / "in.right.0003.exr", noise_frame(3, 40, 32), {});
  expect_error(becalm(command("in.%V.####.exr", "bad.%V.####.exr")), 3,
               {"in.left.0003.exr", "in.right.0003.exr", "40x32", "48x32"});
}

TEST_F(Stereo, AFrameOfOneEyeAloneCountsAsMissing) {
  for (const int number : {1, 2, 3}) {
    for (const char* eye : {"left", "right"}) {
      io::write_exr(frame_path(folder_ / fmt::format("in.{}.####.exr", eye), number),
                    noise_frame(number, 16, 16), {}, io::PixelType::float32);
    }
  }
  fs::remove(folder_ / "in.right.0002.exr");
  const Outcome held = becalm_done(command("in.%V.####.exr", "out.%V.####.exr", {"--missing", "hold"}));
  EXPECT_NE(held.err.find("frame 2 is not on disk in both and holds the one before it"), std::string::npos)
      << held.err;
  for (const char* eye : {"left", "right"}) {
    EXPECT_EQ(io::read_attribute(folder_ / fmt::format("out.{}.0002.exr", eye), "becalm:held_from"), "1");
  }
}

TEST(StereoText, IsReadAsItIsWritten) {
  const StereoView view{.camera = {.focal_px = 1200.5, .separation = 0.065, .convergence = 2.25},
                        .eye = Eye::right};
  EXPECT_EQ(io::format_stereo(view), "right focal_px=1200.5 separation=0.065 convergence=2.25");
  EXPECT_EQ(io::parse_stereo(io::format_stereo(view)), view);
  for (const char* text :
       {"", "left", "left focal_px=1 separation=1", "up focal_px=1 separation=1 convergence=1",
        "left focal_px=nan separation=1 convergence=1", "left focal_px=0 separation=1 convergence=1",
        "left focal_px=1 separation=1 convergence=1 more", "left focal=1 separation=1 convergence=1"}) {
    EXPECT_FALSE(io::parse_stereo(text)) << text;
  }
}

}  // namespace
}  // namespace becalm::test
