// becalm render: --resume.

#include <gtest/gtest.h>

#include "tests/end_to_end/render_fixture.h"

namespace becalm::test {
namespace {

TEST_F(Render, ResumeWritesOnlyWhatIsMissing) {
  render("whole.####.exr");
  render("a.####.exr");
  fs::remove(folder_ / "a.0003.exr");
  const auto written_before = fs::last_write_time(folder_ / "a.0002.exr");
  const Outcome outcome =
      becalm_done({"render", scene_, "-o", folder_ / "a.####.exr", "--spp", "2", "--resume"});
  EXPECT_NE(outcome.err.find("3 were there already"), std::string::npos) << outcome.err;
  EXPECT_EQ(fs::last_write_time(folder_ / "a.0002.exr"), written_before);
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 4);
  const Outcome again =
      becalm_done({"render", scene_, "-o", folder_ / "a.####.exr", "--spp", "2", "--resume"});
  EXPECT_NE(again.err.find("all 4 frames are there"), std::string::npos) << again.err;
}

TEST_F(Render, ResumeRendersDamagedFramesAgain) {
  render("whole.####.exr", {"--frames", "1-2"});
  render("a.####.exr", {"--frames", "1-2"});
  fs::resize_file(folder_ / "a.0001.exr", fs::file_size(folder_ / "a.0001.exr") - 200);
  const Outcome outcome = render("a.####.exr", {"--frames", "1-2", "--resume"});
  EXPECT_NE(outcome.err.find("a.0001.exr is damaged"), std::string::npos) << outcome.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 2);
}

TEST_F(Render, ResumeRefusesOtherSettingsAndNamesThem) {
  render("a.####.exr", {"--frames", "1-2"});
  const auto resume = [&](std::vector<std::string> more) {
    more.push_back("--resume");
    return becalm(command("a.####.exr", more));
  };
  expect_error(resume({"--seed", "5"}), 2, {"a.0001.exr", "seed=0", "seed=5"});
  expect_error(resume({"--size", "24x16"}), 2, {"a.0001.exr", "size=48x32", "size=24x16"});
  expect_error(resume({"--aovs", "normal"}), 2, {"a.0001.exr", "aovs=none", "aovs=normal"});
  expect_error(resume({"--denoise"}), 2, {"a.0001.exr"});
  expect_error(resume({"--aov-spp", "32"}), 2, {"a.0001.exr", "aov_spp=16", "aov_spp=32"});
  expect_error(resume({"--type", "float"}), 2, {"a.0001.exr", "color=half", "color=float"});
  expect_error(resume({"--spp", "3"}), 2, {"a.0001.exr", "spp=2", "spp=3"});
  expect_error(resume({"--reproducible"}), 2, {"a.0001.exr", "reproducible=yes"});
}

TEST_F(Render, ResumeRefusesAnotherFramesPicture) {
  render("a.exr", {"--frames", "3"});
  EXPECT_EQ(becalm(command("a.exr", {"--frames", "3", "--resume"})).status, 0);
  expect_error(becalm(command("a.exr", {"--frames", "4", "--resume"})), kUsage,
               {"a.exr", "becalm:frame 3, and this run has 4"});
  render("both.####.exr", {"--frames", "1-2", "--denoise", "--keep-noisy", folder_ / "noisy.####.exr"});
  fs::copy_file(folder_ / "noisy.0001.exr", folder_ / "noisy.0002.exr", fs::copy_options::overwrite_existing);
  fs::remove(folder_ / "both.0002.exr");
  expect_error(becalm(command("both.####.exr", {"--frames", "1-2", "--denoise", "--keep-noisy",
                                                folder_ / "noisy.####.exr", "--resume"})),
               kUsage, {"noisy.0002.exr", "becalm:frame 1, and this run has 2"});
}

TEST_F(Render, ResumeRefusesAScenePipedIn) {
  const Outcome outcome =
      becalm_redirected({"render", "/dev/stdin", "-o", folder_ / "a.####.exr", "--frames", "1", "--resume"},
                        "< <(cat '" + scene_ + "')");
  expect_error(outcome, 3, {"/dev/stdin: not a file, expected a JSON file"});
  EXPECT_FALSE(fs::exists(folder_ / "a.0001.exr"));
}

TEST_F(Render, ResumeNoticesAnEditedMesh) {
  write_text(folder_ / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_text(
      scene_,
      R"({"film": {"width": 16, "height": 16}, "camera": {"look_at": {"eye": [0, 0, 4], "target": [0, 0, 0]}}, "environment": {"radiance": [1, 1, 1]},
    "frames": {"first": 1, "last": 2}, "materials": {"m": {"type": "diffuse", "reflectance": 0.5}},
    "meshes": {"t": {"obj": "mesh.obj"}}, "objects": [{"name": "o", "mesh": "t", "material": "m"}]})");
  render("a.####.exr", {"--frames", "1"});
  write_text(folder_ / "mesh.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_error(becalm(command("a.####.exr", {"--resume"})), 2, {"a.0001.exr", "scene"});
}

TEST_F(Render, ResumeNoticesFilesOfMeshesAndMaterialsOfAnyName) {
  const auto write_mesh = [&](int side) {
    write_text(folder_ / "mesh.obj", fmt::format("v 0 0 0\nv {} 0 0\nv 0 1 0\nf 1 2 3\n", side));
  };
  const auto write_image = [&](int number) {
    io::write_exr(folder_ / "image.exr", noise_frame(number, 4, 4), {});
  };
  write_text(
      scene_,
      R"({"film": {"width": 16, "height": 16}, "camera": {"look_at": {"eye": [0, 0, 4], "target": [0, 0, 0]}}, "environment": {"radiance": [1, 1, 1]},
    "frames": {"first": 1, "last": 2}, "materials": {"plain": {"type": "diffuse", "reflectance": 0.5}, "material": {"type": "diffuse", "reflectance": {"image": "image.exr"}}},
    "meshes": {"name": {"obj": "mesh.obj"}, "r": {"shape": "rectangle"}},
    "objects": [{"mesh": "name", "material": "plain"}, {"mesh": "r", "material": "material"}]})");
  write_mesh(1);
  write_image(1);
  render("a.####.exr", {"--frames", "1"});
  write_mesh(2);
  expect_error(becalm(command("a.####.exr", {"--resume"})), 2, {"a.0001.exr", "scene"});
  write_mesh(1);
  write_image(2);
  expect_error(becalm(command("a.####.exr", {"--resume"})), 2, {"a.0001.exr", "scene"});
}

TEST_F(Render, ResumeNoticesAnEditedMaterialOfAMeshAndItsImage) {
  write_text(folder_ / "mesh.obj",
             "mtllib my mesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  write_text(folder_ / "my mesh.mtl", "newmtl m\nKd 1 0 0\nmap_Kd -s 2 2 1 my image.exr\n");
  io::write_exr(folder_ / "my image.exr", noise_frame(1, 4, 4), {});
  write_mesh_scene("o");
  render("a.####.exr", {"--frames", "1"});
  render("a.####.exr", {"--frames", "1", "--resume"});
  io::write_exr(folder_ / "my image.exr", noise_frame(2, 4, 4), {});
  expect_error(becalm(command("a.####.exr", {"--resume"})), 2, {"a.0001.exr", "scene"});
  io::write_exr(folder_ / "my image.exr", noise_frame(1, 4, 4), {});
  write_text(folder_ / "my mesh.mtl", "newmtl m\nKd 0 1 0\nmap_Kd -s 2 2 1 my image.exr\n");
  expect_error(becalm(command("a.####.exr", {"--resume"})), 2, {"a.0001.exr", "scene"});
}

TEST_F(Render, ResumeNoticesAnEditedMaterialBehindAByteOrderMarkAndAContinuedLine) {
  write_text(folder_ / "mesh.obj",
             "\xef\xbb\xbfmtllib \\\nmesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  write_text(folder_ / "mesh.mtl", "newmtl m\nKd 1 0 0\n");
  write_mesh_scene("o");
  render("a.####.exr", {"--frames", "1"});
  write_text(folder_ / "mesh.mtl", "newmtl m\nKd 0 1 0\n");
  expect_error(becalm(command("a.####.exr", {"--resume"})), 2, {"a.0001.exr", "scene"});
}

TEST_F(Render, ResumeReplacesFilesOfOthersIfTold) {
  render("a.####.exr", {"--frames", "1"});
  io::write_exr(folder_ / "a.0002.exr", noise_frame(1, 4, 4), {});
  write_text(folder_ / "a.0003.exr", "notes");
  expect_error(becalm(command("a.####.exr", {"--resume"})), 2, {"a.0002.exr", "--overwrite replaces it"});
  const Outcome outcome =
      becalm_done({"render", scene_, "-o", folder_ / "a.####.exr", "--spp", "2", "--resume", "--overwrite"});
  EXPECT_NE(outcome.err.find("frame 2"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("frame 1:"), std::string::npos) << outcome.err;
  EXPECT_EQ(read_frame(folder_ / "a.0002.exr").width(), read_frame(folder_ / "a.0001.exr").width());
}

TEST_F(Render, ResumedDenoiseWhileRenderingIsTheSame) {
  const std::vector<std::string> options{"--denoise=draft", "--spp", "1", "--keep-noisy",
                                         folder_ / "kept.####.exr"};
  const auto go = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / "a.####.exr", "--profile"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return becalm_done(arguments);
  };
  go({});
  for (int frame = 1; frame <= 4; ++frame) {
    fs::copy_file(frame_path(folder_ / "a.####.exr", frame), frame_path(folder_ / "whole.####.exr", frame));
  }
  fs::remove(folder_ / "a.0002.exr");
  fs::remove(folder_ / "a.0003.exr");
  fs::remove(folder_ / "kept.0003.exr");
  const auto fourth = fs::last_write_time(folder_ / "a.0004.exr");
  const Outcome outcome = go({"--resume"});
  EXPECT_NE(outcome.err.find("frame 1: exists"), std::string::npos) << outcome.err;
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 4);
  EXPECT_EQ(fs::last_write_time(folder_ / "a.0004.exr"), fourth);
}

TEST_F(Render, ResumeMakesFramesAgainThatWereMadeFromOthers) {
  for (const std::string preset : {"balanced", "draft"}) {
    const auto go = [&](const std::string& name, const std::vector<std::string>& more) {
      std::vector<std::string> options{"--spp", "1", "--denoise=" + preset};
      options.insert(options.end(), more.begin(), more.end());
      return render(preset + "/" + name + ".####.exr", options);
    };
    go("whole", {"--frames", "1-5"});
    go("a", {"--frames", "1-5x2"});
    const Outcome outcome = go("a", {"--frames", "1-5", "--resume"});
    EXPECT_NE(outcome.err.find("made again"), std::string::npos) << outcome.err;
    // Not 1-5x2, of a shot on twos; draft reads no frame after the first.
    const std::string again_frames = preset == "draft" ? "them: 3,5\n" : "them: 1,3,5\n";
    EXPECT_NE(outcome.err.find(again_frames), std::string::npos) << outcome.err;
    expect_same_beauty(folder_ / (preset + "/whole.####.exr"), folder_ / (preset + "/a.####.exr"), 1, 5);
    const Outcome again = go("a", {"--frames", "1-5", "--resume"});
    EXPECT_EQ(again.err.find("made again"), std::string::npos) << again.err;
  }
}

TEST_F(Render, ResumeMakesTheNoisyFramesThatAreAskedForLater) {
  const auto go = [&](const std::vector<std::string>& more) {
    std::vector<std::string> options{"--spp", "1", "--denoise", "--frames", "1-2", "--context", "none"};
    options.insert(options.end(), more.begin(), more.end());
    return render("a.####.exr", options);
  };
  go({});
  go({"--keep-noisy", folder_ / "n.####.exr", "--resume"});
  const std::string noisy = folder_ / "n.0002.exr";
  ASSERT_TRUE(fs::exists(folder_ / "n.0001.exr") && fs::exists(noisy));
  fs::resize_file(noisy, fs::file_size(noisy) - 200);
  const Outcome outcome = go({"--keep-noisy", folder_ / "n.####.exr", "--resume"});
  EXPECT_NE(outcome.err.find("n.0002.exr is damaged"), std::string::npos) << outcome.err;
  EXPECT_EQ(read_frame(noisy).width(), read_frame(folder_ / "n.0001.exr").width());
}

class StoppedDenoise : public Render {
 protected:
  /// What a run for frames 1 to 4 has left that was stopped before it wrote the frames from `first_missing`
  /// on: its noisy frames, in files of this name, and the frames before.
  void stop(int first_missing, const std::string& noisy, const std::vector<std::string>& options) {
    std::vector<std::string> all{"--frames", "1-4", "--keep-noisy", folder_ / noisy};
    all.insert(all.end(), options.begin(), options.end());
    render("a.####.exr", all);
    for (int frame = first_missing; frame <= 4; ++frame)
      fs::remove(frame_path(folder_ / "a.####.exr", frame));
  }
};

TEST_F(StoppedDenoise, CompletedLeavesNoNoisyFrames) {
  std::vector<std::string> options{"--denoise=balanced", "--segment", "2", "--warmup", "1"};
  stop(4, "a.####.becalm-scratch-1-4.exr", options);  // frame 4 needs the noisy frames 3 and 4 only
  options.insert(options.end(), {"--frames", "1-4", "--resume"});
  render("a.####.exr", options);
  for (const std::string& name : files_in(folder_.path())) {
    EXPECT_EQ(name.find("becalm-scratch"), std::string::npos) << name;
  }
}

TEST_F(StoppedDenoise, ResumesWithTheSamplesOfTheNoisyFrames) {
  const std::vector<std::string> budget{"--denoise", "--time-budget", "1s", "--frames", "1-4", "--resume"};
  const std::vector<std::string> sampled{"--denoise=balanced", "--adaptive", "--spp", "3"};
  const auto expect_resumed = [&] {
    EXPECT_EQ(io::read_attribute(folder_ / "a.0001.exr", "becalm:preset"), "balanced");
    const std::string settings = io::read_attribute(folder_ / "a.0001.exr", "becalm:settings");
    EXPECT_NE(settings.find(" spp=3 "), std::string::npos) << settings;
  };
  const auto resume = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / "a.####.exr"};
    arguments.insert(arguments.end(), budget.begin(), budget.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = becalm_done(arguments);
    EXPECT_NE(outcome.err.find("3 samples per pixel and balanced, as in the frames that are there"),
              std::string::npos)
        << outcome.err;
  };
  stop(1, "a.####.becalm-scratch-1-4.exr", sampled);
  resume({});
  expect_resumed();
  stop(1, "kept.####.exr", sampled);
  resume({"--keep-noisy", folder_ / "kept.####.exr"});
  expect_resumed();
}

}  // namespace
}  // namespace becalm::test
