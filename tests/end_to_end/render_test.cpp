// becalm render: what it writes.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "tests/end_to_end/render_fixture.h"

namespace becalm::test {
namespace {

TEST_F(Render, WritesTheScenesFramesWithTheLayersAskedFor) {
  const Outcome outcome = render("new/folder/a.####.exr", {"--aovs", "albedo,depth"});
  EXPECT_EQ(files_in(folder_.path() / "new" / "folder"),
            (std::vector<std::string>{"a.0001.exr", "a.0002.exr", "a.0003.exr", "a.0004.exr"}));
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "");
  const std::string path = folder_ / "new/folder/a.0003.exr";
  const Frame frame = read_frame(path, all_aovs());
  EXPECT_EQ(frame.width(), 48);
  EXPECT_EQ(frame.height(), 32);
  for (const AovInfo& entry : kAovTable) {
    const bool expected = entry.aov == Aov::beauty || entry.aov == Aov::albedo || entry.aov == Aov::depth;
    EXPECT_EQ(frame.has(entry.aov), expected) << entry.name;
  }
  EXPECT_NE(io::read_attribute(path, "becalm:version"), "");
  const std::string settings = io::read_attribute(path, "becalm:settings");
  for (const char* word : {"scene=", "size=48x32", "spp=2", "seed=0", "aovs=albedo,depth", "color=half"}) {
    EXPECT_NE(settings.find(word), std::string::npos) << word << " in " << settings;
  }
}

TEST_F(Render, LightGroupsAreLayers) {
  render("a.exr", {"--frames", "1", "--aovs", "light_groups"});
  const Outcome info = becalm_done({"info", folder_ / "a.exr"});
  EXPECT_NE(info.out.find("light.default"), std::string::npos) << info.out;
  render("b.exr", {"--frames", "1", "--aovs", "all"});
  EXPECT_EQ(becalm_done({"info", folder_ / "b.exr"}).out.find("light."), std::string::npos);
}

TEST_F(Render, LightGroupsAreDenoisedUnlessToldOtherwise) {
  const auto read = [&](const std::string& file) {
    return io::read_exr(folder_ / file, 1, {}, {}, io::LightGroups::read).frame;
  };
  render("a.exr", {"--frames", "1", "--aovs", "light_groups", "--float"});
  const Frame noisy = read("a.exr");
  for (const char* preset : {"--denoise=draft", "--denoise"}) {
    render("b.exr", {"--frames", "1", "--aovs", "light_groups", "--float", preset});
    const Frame denoised = read("b.exr");
    EXPECT_EQ(io::read_attribute(folder_ / "b.exr", "becalm:alpha"), "passed on");
    ASSERT_EQ(denoised.light_groups().size(), 1u);
    EXPECT_EQ(denoised.light_groups()[0].name, "default");
    EXPECT_EQ(same_pixels(noisy.light_groups()[0].radiance, denoised.light_groups()[0].radiance),
              same_pixels(noisy.image(Aov::beauty), denoised.image(Aov::beauty)))
        << preset;
    for (std::size_t i = 0; i < denoised.image(Aov::beauty).pixel_count(); ++i) {
      const float beauty = denoised.image(Aov::beauty).data()[4 * i];
      ASSERT_NEAR(denoised.light_groups()[0].radiance.data()[3 * i], beauty, 1e-5f * beauty + 1e-6f) << i;
    }
    render("b.exr", {"--frames", "1", "--aovs", "light_groups", "--float", preset, "--additive", "none"});
    EXPECT_TRUE(same_pixels(noisy.light_groups()[0].radiance, read("b.exr").light_groups()[0].radiance));
  }
}

TEST_F(Render, NoisyFramesThatTheFilterReadsAreGoneAtTheEnd) {
  const Outcome outcome = becalm_done(
      {"render", scene_, "-o", folder_ / "out/a.####.exr", "--spp", "1", "--denoise", "--frames", "2-3"});
  EXPECT_EQ(files_in(folder_.path() / "out"), (std::vector<std::string>{"a.0002.exr", "a.0003.exr"}));
  EXPECT_NE(outcome.err.find("2 frames more are rendered"), std::string::npos) << outcome.err;
  render("whole.####.exr", {"--spp", "1", "--denoise"});
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "out/a.####.exr", 2, 3);
  render("alone.####.exr", {"--spp", "1", "--denoise", "--frames", "2", "--context", "none"});
  EXPECT_FALSE(same_pixels(read_frame(folder_ / "alone.0002.exr").image(Aov::beauty),
                           read_frame(folder_ / "whole.0002.exr").image(Aov::beauty)));
}

TEST_F(Render, FramesHereAndThereAreThoseOfTheWholeSequence) {
  render("whole.####.exr", {"--spp", "1", "--denoise"});
  render("some.####.exr", {"--spp", "1", "--denoise", "--frames", "1,4"});
  for (const int frame : {1, 4})
    expect_same_beauty(folder_ / "whole.####.exr", folder_ / "some.####.exr", frame, frame);
}

TEST_F(Render, EvenlySpacedFramesAreOfAShotOnTwosOnlyIfTheRangeSaysSo) {
  std::ifstream file(scene_);
  std::string text(std::istreambuf_iterator<char>(file), {});
  const std::string four = R"("last": 4)";
  text.replace(text.find(four), four.size(), R"("last": 6)");
  write_text(scene_, text);
  const auto frames = [&](const std::string& name, const std::string& range) {
    render(name + ".####.exr", {"--spp", "1", "--denoise", "--frames", range});
  };
  const auto expect_same = [&](const std::string& whole, const std::string& part, int frame) {
    expect_same_beauty(folder_ / (whole + ".####.exr"), folder_ / (part + ".####.exr"), frame, frame);
  };
  frames("ones", "1-6");
  frames("lost", "1,3,5");
  frames("twos", "1-5x2");
  frames("first", "1-3x2");
  frames("last", "5-5x2");
  for (const int frame : {1, 3, 5}) {
    expect_same("ones", "lost", frame);
    expect_same("twos", frame == 5 ? "last" : "first", frame);
  }
  EXPECT_FALSE(same_pixels(read_frame(folder_ / "ones.0003.exr").image(Aov::beauty),
                           read_frame(folder_ / "twos.0003.exr").image(Aov::beauty)));
}

TEST_F(Render, FramesThatContextNamesMayBeFartherApart) {
  const std::vector<std::string> named{"--frames", "3", "--context", "1-5x2"};
  std::vector<std::string> rendered{"--float", "--spp", "1", "--denoise"};
  rendered.insert(rendered.end(), named.begin(), named.end());
  render("both.####.exr", rendered);
  render("noisy.####.exr",
         {"--float", "--spp", "1", "--frames", "1-5", "--aovs", "albedo,normal,depth,motion,variance"});
  std::vector<std::string> denoised{"denoise", folder_ / "noisy.####.exr", "-o", folder_ / "then.####.exr",
                                    "--quiet"};
  denoised.insert(denoised.end(), named.begin(), named.end());
  becalm_done(denoised);
  expect_same_beauty(folder_ / "both.####.exr", folder_ / "then.####.exr", 3, 3);
}

TEST_F(Render, NoisyFramesThatAStoppedRunLeftAreGoneWhenAllIsThere) {
  const std::vector<std::string> options{"--spp", "1", "--denoise", "--frames", "1-2", "--context", "none"};
  const auto with = [&](const std::string& option) {
    std::vector<std::string> all = options;
    all.push_back(option);
    return all;
  };
  std::vector<std::string> keeps = options;
  keeps.insert(keeps.end(), {"--keep-noisy", folder_ / "out/a.####.becalm-scratch-1-2.exr"});
  render("out/a.####.exr", keeps);
  EXPECT_EQ(files_in(folder_.path() / "out").size(), 4u);
  render("out/a.####.exr", with("--resume"));
  EXPECT_EQ(files_in(folder_.path() / "out"), (std::vector<std::string>{"a.0001.exr", "a.0002.exr"}));
}

TEST_F(Render, NoisyFramesThatRunsOfOtherFramesLeftAreGoneOnceTheirFramesAreRenderedAgain) {
  fs::create_directories(folder_ / "out");
  for (const char* name :
       {"a.0001.becalm-scratch-1-4.exr", "a.0002.becalm-scratch-3-4.exr", "b.0001.becalm-scratch-1-4.exr"})
    write_text((folder_.path() / "out" / name).string(), "noise");
  render("out/a.####.exr", {"--spp", "1", "--denoise", "--frames", "1", "--context", "none"});
  EXPECT_EQ(files_in(folder_.path() / "out"),
            (std::vector<std::string>{"a.0001.exr", "a.0002.becalm-scratch-3-4.exr",
                                      "b.0001.becalm-scratch-1-4.exr"}))
      << "one that a run still has, and one of other outputs";
}

TEST_F(Render, NoisyFramesThatAreKeptOutliveLaterRuns) {
  const std::vector<std::string> options{"--spp", "1", "--denoise", "--frames", "1-2", "--context", "none"};
  std::vector<std::string> keeps = options;
  keeps.insert(keeps.end(), {"--keep-noisy", folder_ / "out/a.####.noisy.exr"});
  render("out/a.####.exr", keeps);
  render("out/a.####.exr", options);
  EXPECT_EQ(files_in(folder_.path() / "out"),
            (std::vector<std::string>{"a.0001.exr", "a.0001.noisy.exr", "a.0002.exr", "a.0002.noisy.exr"}));
}

TEST_F(Render, SegmentsThatTheTracerRunsAheadOfAreThoseOfRenderThenDenoise) {
  const std::vector<std::string> segments{"--segment", "1", "--warmup", "1"};
  std::vector<std::string> options{"--float", "--spp", "1", "--denoise"};
  options.insert(options.end(), segments.begin(), segments.end());
  render("out/both.####.exr", options);
  EXPECT_EQ(files_in(folder_.path() / "out").size(), 4u);
  render("noisy.####.exr", {"--float", "--spp", "1", "--aovs", "albedo,normal,depth,motion,variance"});
  std::vector<std::string> denoise{"denoise", folder_ / "noisy.####.exr", "-o", folder_ / "then.####.exr",
                                   "--quiet"};
  denoise.insert(denoise.end(), segments.begin(), segments.end());
  becalm_done(denoise);
  expect_same_beauty(folder_ / "out/both.####.exr", folder_ / "then.####.exr", 1, 4);
}

TEST_F(Render, AFrameThatCannotBeWrittenEndsTheRun) {
  const auto expect_end = [&](int last, std::vector<std::string> more) {
    more.insert(more.end(), {"--frames", fmt::format("1-{}", last)});
    Process process(command("out/a.####.exr", more));
    EXPECT_TRUE(wait_until([&] { return fs::exists(folder_ / "out/a.0001.exr"); }));
    const std::string in_the_way = frame_path(folder_ / "out/a.####.exr", last);
    fs::create_directories(in_the_way);
    expect_error(process.wait(), 4, {in_the_way});
    fs::remove_all(folder_ / "out");
  };
  expect_end(400, {});
  expect_end(60, {"--denoise=draft"});
  expect_end(24, {"--denoise"});
}

TEST_F(Render, OneFrameNeedsNoFieldAndSizeIsAChoice) {
  render("a.exr", {"--frames", "2", "--size", "9x7"});
  const Frame frame = read_frame(folder_ / "a.exr");
  EXPECT_EQ(frame.width(), 9);
  EXPECT_EQ(frame.height(), 7);
}

TEST_F(Render, FeaturesOfMoreSamplesLeaveTheBeautyAsItIs) {
  const std::vector<std::string> options{"--frames", "1", "--spp", "1", "--aovs", "albedo"};
  render("a.exr", options);
  std::vector<std::string> one_sample = options;
  one_sample.insert(one_sample.end(), {"--aov-spp", "1"});
  render("b.exr", one_sample);
  const Frame a = read_frame(folder_ / "a.exr", all_aovs());
  const Frame b = read_frame(folder_ / "b.exr", all_aovs());
  EXPECT_TRUE(same_pixels(a.image(Aov::beauty), b.image(Aov::beauty)));
  EXPECT_FALSE(same_pixels(a.image(Aov::albedo), b.image(Aov::albedo))) << "edges have more samples";
}

TEST_F(Render, SeedChangesTheNoiseAndThreadsDoNot) {
  render("a.####.exr", {"--frames", "1", "--threads", "1"});
  render("b.####.exr", {"--frames", "1", "--threads", "2"});
  render("c.####.exr", {"--frames", "1", "--seed", "7"});
  const Frame a = read_frame(folder_ / "a.0001.exr");
  EXPECT_TRUE(same_pixels(a.image(Aov::beauty), read_frame(folder_ / "b.0001.exr").image(Aov::beauty)));
  EXPECT_FALSE(same_pixels(a.image(Aov::beauty), read_frame(folder_ / "c.0001.exr").image(Aov::beauty)));
}

/// Whether `--threads` reaches a graphics card's driver does not matter.
TEST_F(Render, TheSoftwareDeviceHasTheThreadsAskedFor) {
  const std::vector<std::string> arguments =
      command("a.exr", {"--frames", "1", "--denoise=draft", "--device", "llvmpipe", "--threads", "3"});
  const Outcome outcome =
      Process(
          arguments,
          R"("$0" "$@" & while kill -0 $!; do cat /proc/$!/task/*/comm; sleep 0.02; done 2>/dev/null; wait $!)")
          .wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("llvmpipe-2\n"), std::string::npos)
      << "or the driver names its threads otherwise";
  EXPECT_EQ(outcome.out.find("llvmpipe-3\n"), std::string::npos);
}

TEST_F(Render, ProgressIsOneLineAFrameOffTheTerminal) {
  const Outcome outcome = becalm_done({"render", scene_, "-o", folder_ / "a.####.exr", "--spp", "1"});
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 5) << outcome.err;
  EXPECT_EQ(outcome.err.find('\r'), std::string::npos);
  EXPECT_NE(outcome.err.find("frame 2: written, 2 of 4 done"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("samples/s"), std::string::npos) << outcome.err;
}

TEST_F(Render, HalfOverflowsAreReportedOnceAFrame) {
  std::ifstream file(scene_);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text.replace(text.find("[8, 8, 7]"), 9, "[1e7, 1e7, 1e7]");
  write_text(scene_, text);
  const Outcome outcome = render("a.####.exr", {"--frames", "1-2"});
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 2) << outcome.err;
  EXPECT_NE(outcome.err.find("frame 1: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("beyond half's range"), std::string::npos) << outcome.err;
  EXPECT_EQ(render("b.####.exr", {"--frames", "1-2", "--float"}).err, "");
}

TEST_F(Render, DebugPixelPrintsAPathAndWritesNothing) {
  const Outcome outcome = becalm_done({"render", scene_, "--frames", "2", "--debug-pixel", "24,20,1"});
  for (const char* words : {"throughput", "albedo [", "motion ["}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << outcome.out;
  }
  EXPECT_EQ(files_in(folder_.path()), std::vector<std::string>{"scene.json"});
}

TEST_F(Render, PaddedNumbersAreDecimal) {
  becalm_done({"render", scene_, "-o", folder_ / "a.exr", "--frames", "2", "--spp", "010"});
  const std::string settings = io::read_attribute(folder_ / "a.exr", "becalm:settings");
  EXPECT_NE(settings.find("spp=10 "), std::string::npos) << settings;
}

TEST_F(Render, AllAovsMayHaveLightGroupsBesides) {
  becalm_done({"render", scene_, "-o", folder_ / "a.exr", "--frames", "2", "--spp", "1", "--aovs",
               "all,light_groups"});
  const std::string settings = io::read_attribute(folder_ / "a.exr", "becalm:settings");
  for (const char* name : {"material_id", "light_groups"}) {
    EXPECT_NE(settings.find(name), std::string::npos) << settings;
  }
  expect_error(becalm({"render", scene_, "-o", folder_ / "b.exr", "--frames", "2", "--spp", "1", "--aovs",
                       "all,half_a"}),
               2, {"half_a", "2 samples"});
}

TEST_F(Render, WhatTheSceneReadsIsNotReplaced) {
  write_text(folder_ / "mesh.obj",
             "mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  write_text(folder_ / "mesh.mtl", "newmtl m\nKd 1 0 0\nmap_Kd image.0001.exr\n");
  // Of becalm, so that nothing else protects it.
  io::write_exr(folder_ / "image.0001.exr", noise_frame(1, 4, 4), {{"becalm:version", "1"}});
  write_mesh_scene("a.0001.exr");
  render("a.####.exr", {"--frames", "1"});
  render("a.####.exr", {"--frames", "1"});
  expect_error(becalm(command("image.####.exr", {"--overwrite"})), 2,
               {"image.0001.exr", "would overwrite the input"});
  expect_error(becalm(command("a.####.exr", {"--denoise", "--keep-noisy", folder_ / "image.####.exr"})), 2,
               {"--keep-noisy", "image.0001.exr", "would overwrite the input"});
}

TEST_F(Render, ASingleSampleHasNoHalves) {
  render("a.####.exr", {"--frames", "1", "--spp", "1", "--aovs", "all"});
  const Frame frame = read_frame(folder_ / "a.0001.exr", all_aovs());
  EXPECT_TRUE(frame.has(Aov::variance));
  EXPECT_FALSE(frame.has(Aov::half_a));
  expect_error(becalm(command("b.####.exr", {"--spp", "1", "--aovs", "albedo,half_b"})), 2,
               {"--aovs", "at least 2 samples", "half_b"});
}

TEST_F(Render, ANoiseTargetIsANumber) {
  for (const char* target : {"nan", "0", "11", "much"}) {
    expect_error(becalm(command("a.####.exr", {"--denoise", "--noise-target", target})), 2,
                 {"--noise-target", "a number from 0.0001 to 10"});
  }
}

/// Two machines of a farm: the frames that one reads for those before and after are the other's.
TEST_F(Render, JobsThatReadEachOthersFramesRunSideBySide) {
  const auto job = [&](const std::string& frames) {
    return command("out/a.####.exr", {"--spp", "1", "--denoise", "--frames", frames});
  };
  Process first(job("1-2"));
  Process second(job("3-4"));
  for (Process* process : {&first, &second}) {
    const Outcome outcome = process->wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
  EXPECT_EQ(files_in(folder_.path() / "out"),
            (std::vector<std::string>{"a.0001.exr", "a.0002.exr", "a.0003.exr", "a.0004.exr"}));
}

TEST_F(Render, DenoiseWhileRenderingIsRenderThenDenoise) {
  render("both.####.exr",
         {"--float", "--denoise", "--keep-noisy", folder_ / "kept.####.exr", "--aovs", "albedo"});
  render("noisy.####.exr", {"--float", "--aovs", "albedo,normal,depth,motion,variance,half_a,half_b"});
  becalm_done({"denoise", folder_ / "noisy.####.exr", "-o", folder_ / "then.####.exr", "--quiet"});
  expect_same_beauty(folder_ / "both.####.exr", folder_ / "then.####.exr", 1, 4);
  expect_same_beauty(folder_ / "kept.####.exr", folder_ / "noisy.####.exr", 1, 4);
  const Frame second = read_frame(folder_ / "both.0002.exr", all_aovs());
  EXPECT_FALSE(
      same_pixels(second.image(Aov::beauty), read_frame(folder_ / "noisy.0002.exr").image(Aov::beauty)))
      << "the filter did nothing";
  EXPECT_TRUE(second.has(Aov::albedo));
  EXPECT_FALSE(second.has(Aov::normal)) << "rendered for the filter, and not asked for";
  EXPECT_EQ(io::read_attribute(folder_ / "both.0002.exr", "becalm:preset"), "balanced");
}

TEST_F(Render, AForwardFilterSeesCutsGapsAndContextAsDenoiseDoes) {
  render("noisy.####.exr", {"--float", "--spp", "1", "--aovs", "albedo,normal,depth,motion,variance"});
  const auto expect_same = [&](const std::vector<std::string>& options, int first, int last) {
    std::vector<std::string> rendered{"--float", "--spp", "1", "--denoise=draft", "--overwrite"};
    std::vector<std::string> denoised{"denoise",  folder_ / "noisy.####.exr",
                                      "-o",       folder_ / "then.####.exr",
                                      "--preset", "draft",
                                      "--quiet",  "--overwrite"};
    rendered.insert(rendered.end(), options.begin(), options.end());
    denoised.insert(denoised.end(), options.begin(), options.end());
    render("both.####.exr", rendered);
    becalm_done(denoised);
    for (const int frame : {first, last}) {
      expect_same_beauty(folder_ / "both.####.exr", folder_ / "then.####.exr", frame, frame);
    }
  };
  expect_same({"--cuts", "3"}, 1, 4);
  expect_same({"--cuts", "none", "--frames", "1,2,4"}, 1, 4);
  expect_same({"--cuts", "none", "--frames", "3-4", "--context", "1-4"}, 3, 4);
}

TEST_F(Render, ValidationNeedsItsLayer) {
  const std::vector<std::string> arguments =
      command("a.####.exr", {"--denoise", "--validate", "--frames", "1"});
  expect_error(Process(arguments, R"(VK_LAYER_PATH=/nonexistent exec "$0" "$@")").wait(), 4,
               {"vulkan-validationlayers"});
}

TEST_F(Render, ValidationIsSilent) {
  const Outcome outcome =
      render("a.####.exr", {"--denoise", "--validate", "--diagnostics", "--frames", "1-2"});
  EXPECT_EQ(outcome.err, "");
  const Frame frame = read_frame(folder_ / "a.0002.exr", all_aovs());
  for (const AovInfo& entry : kAovTable) {
    EXPECT_TRUE(!entry.diagnostic || entry.aov == Aov::stereo_weight || frame.has(entry.aov)) << entry.name;
  }
}

}  // namespace
}  // namespace becalm::test
