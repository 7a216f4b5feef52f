// What a user may get wrong: each gives one line that names the culprit, and its exit status.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

class BadInput : public testing::Test {
 protected:
  void write_noise(const std::string& name, int number, int width = 48, int height = 32) const {
    io::write_exr(folder_ / name, noise_frame(number, width, height), {});
  }
  void replace_in_scene(const std::string& from, const std::string& to) const {
    std::ifstream file(scene_);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    text.replace(text.find(from), from.size(), to);
    write_text(scene_, text);
  }
  Outcome render(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / "out.####.exr"};
    if (!has_option(more, "--spp")) arguments.insert(arguments.end(), {"--spp", "1"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return becalm(arguments);
  }

  TempFolder folder_;
  std::string scene_ = write_scene(folder_);
};

TEST_F(BadInput, WhatIsNotKnownIsToldBeforeWhatIsMissing) {
  expect_error(becalm({"denoize"}), kUsage, {"unknown option or argument: denoize"});
  expect_error(becalm({"denoise", "--preste"}), kUsage, {"denoise: unknown option or argument: --preste"});
  expect_error(becalm({"denoise", "in.####.exr"}), kUsage, {"denoise: --output is required"});
}

TEST_F(BadInput, ANameThatIsTooLongToBeWrittenIsToldBeforeTheWork) {
  write_noise("in.0001.exr", 1);
  const std::string out = folder_ / (std::string(240, 'a') + ".exr");  // a partial file's would not fit
  std::vector<std::string> denoise{"denoise", folder_ / "in.0001.exr", "-o", out};
  expect_error(becalm(denoise), kResource, {"-o ", "File name too long"});
  denoise.emplace_back("--dry-run");
  expect_error(becalm(denoise), kResource, {"-o ", "File name too long"});
}

TEST_F(BadInput, WhatIsNotKnownIsToldInItsOrder) {
  expect_error(render({"--frame", "1"}), kUsage, {"render: unknown option or argument: --frame 1 (did"});
  expect_error(becalm({"info", "a.exr", "b.exr", "c.exr"}), kUsage, {"argument: b.exr c.exr;"});
}

TEST_F(BadInput, WhatIsMissingHasTheNameOfTheHelp) {
  expect_error(becalm({"info"}), kUsage, {"info: SCENE.json|EXR|device is required"});
  expect_error(becalm({"test"}), kUsage, {"test: SUITE.json|DIR... is required"});
  expect_error(becalm({"info", ""}), kUsage, {"info: SCENE.json|EXR|device: is empty"});
}

TEST_F(BadInput, MissingScene) {
  expect_error(becalm({"render", folder_ / "none.json", "-o", folder_ / "out.####.exr"}), kBadInput,
               {"none.json"});
}

TEST_F(BadInput, MissingFile) {
  expect_error(becalm({"denoise", folder_ / "none.exr", "-o", folder_ / "out.exr"}), kBadInput, {"none.exr"});
}

TEST_F(BadInput, SequenceThatIsNotThere) {
  expect_error(becalm({"denoise", folder_ / "none.####.exr", "-o", folder_ / "out.####.exr"}), kBadInput,
               {"none.####.exr", "no frame"});
}

TEST_F(BadInput, MissingFrameOfRange) {
  write_noise("in.0001.exr", 1);
  write_noise("in.0003.exr", 3);
  expect_error(
      becalm({"denoise", folder_ / "in.####.exr", "-o", folder_ / "out.####.exr", "--frames", "1-3"}),
      kBadInput, {"in.####.exr", "frame 2", "--missing"});
  EXPECT_FALSE(fs::exists(folder_ / "out.0001.exr"));
}

TEST_F(BadInput, TruncatedExr) {
  write_noise("in.0001.exr", 1);
  fs::resize_file(folder_ / "in.0001.exr", fs::file_size(folder_ / "in.0001.exr") / 2);
  expect_error(becalm({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "out.exr"}), kBadInput,
               {"in.0001.exr"});
  EXPECT_FALSE(fs::exists(folder_ / "out.exr"));
}

TEST_F(BadInput, NotAnExr) {
  write_text(folder_ / "in.exr", "no image at all");
  expect_error(becalm({"denoise", folder_ / "in.exr", "-o", folder_ / "out.exr"}), kBadInput, {"in.exr"});
}

TEST_F(BadInput, ExrWithoutColor) {
  Frame frame(1, 8, 8);
  frame.add(Aov::depth, 1.0f);
  io::write_exr(folder_ / "depth.exr", frame, {});
  expect_error(becalm({"denoise", folder_ / "depth.exr", "-o", folder_ / "out.exr"}), kBadInput,
               {"depth.exr", "depth.Z"});
}

TEST_F(BadInput, FramesOfDifferentSizes) {
  write_noise("in.0001.exr", 1);
  write_noise("in.0002.exr", 2, 40, 32);
  const Outcome outcome =
      becalm({"denoise", folder_ / "in.####.exr", "-o", folder_ / "out.####.exr", "--quiet"});
  expect_error(outcome, kBadInput, {"in.0001.exr", "in.0002.exr", "40x32", "48x32"});
  const Outcome streamed = becalm(
      {"denoise", folder_ / "in.####.exr", "-o", folder_ / "out.####.exr", "--quiet", "--preset", "draft"});
  expect_error(streamed, kBadInput, {"in.0002.exr", "40x32", "48x32"});
  EXPECT_FALSE(fs::exists(folder_ / "out.0001.exr")) << "sizes are compared before work begins";
}

TEST_F(BadInput, WhatIsWrongWithFramesIsToldAtOnce) {
  const std::string pattern = folder_ / "in.####.exr";
  for (const int number : {2, 4}) io::write_exr(frame_path(pattern, number), noise_frame(number), {});
  write_noise("in.0001.exr", 1, 40, 32);
  for (const int number : {3, 5}) {
    Frame frame = noise_frame(number);
    frame.remove(Aov::albedo);
    io::write_exr(frame_path(pattern, number), frame, {});
  }
  write_noise("in.0006.exr", 6);
  fs::resize_file(folder_ / "in.0006.exr", fs::file_size(folder_ / "in.0006.exr") - 1);
  write_text(folder_ / "in.0007.exr", "no image at all");
  write_noise("in.0008.exr", 8);
  const Outcome outcome = becalm({"denoise", pattern, "-o", folder_ / "out/a.####.exr", "--quiet"});
  EXPECT_EQ(outcome.status, kBadInput);
  EXPECT_EQ(
      outcome.err,
      fmt::format("becalm: {0}/in.0001.exr: is 40x32, and {0}/in.0002.exr is 48x32\n"
                  "becalm: {0}/in.####.exr: frames 3,5: has no layer 'albedo', which {0}/in.0002.exr has\n"
                  "becalm: {0}/in.0006.exr: truncated, corrupt or unsupported EXR: the file ends before "
                  "its pixels do\n"
                  "becalm: {0}/in.0007.exr: not an EXR file\n"
                  "becalm: error: {0}/in.####.exr: 5 of 8 frames cannot be used; nothing was written\n",
                  folder_.path().string()));
  EXPECT_TRUE(files_in(folder_.path() / "out").empty());
}

TEST_F(BadInput, EmptyTexts) {
  write_noise("in.0001.exr", 1);
  const std::string in = folder_ / "in.0001.exr";
  expect_error(becalm({"denoise", "", "-o", folder_ / "out.exr"}), kUsage, {"input", "empty"});
  expect_error(becalm({"denoise", in, "-o", ""}), kUsage, {"--output", "empty"});
  expect_error(becalm({"denoise", in, "-o", folder_ / "out.exr", "--frames", ""}), kUsage,
               {"--frames", "empty"});
  expect_error(render({"--frames", ""}), kUsage, {"--frames", "empty"});
  expect_error(becalm({"info", ""}), kUsage, {"empty"});
  expect_error(becalm({"compare", in, ""}), kUsage, {"empty"});
  for (const char* option : {"--layers", "--device", "--set", "--memory", "--cuts", "--channels"}) {
    expect_error(becalm({"denoise", in, "-o", folder_ / "out.exr", option, ""}), kUsage, {option, "empty"});
  }
  expect_error(becalm({"compare", in, in, "--json", ""}), kUsage, {"--json", "empty"});
  expect_error(render({"--size", ""}), kUsage, {"--size", "empty"});
}

TEST_F(BadInput, EmptyValuesOfOptionsThatNeedNone) {
  expect_error(render({"--denoise="}), kUsage, {"render: --denoise: is empty"});
  expect_error(render({"--quiet="}), kUsage, {"--quiet: is empty"});
  write_noise("in.0001.exr", 1);
  const std::vector<std::string> antialias{"antialias", folder_ / "in.####.exr", "-o",
                                           folder_ / "out.####.exr", "--checkerboard="};
  expect_error(becalm(antialias), kUsage, {"antialias: --checkerboard: is empty"});
  EXPECT_FALSE(fs::exists(folder_ / "out.0001.exr"));
}

TEST_F(BadInput, WhatIsWrongWithAllFramesIsToldOnce) {
  for (const int number : {1, 2, 3}) {
    Frame frame(number, 8, 8);
    frame.add(Aov::depth, 1.0f);
    io::write_exr(frame_path(folder_ / "in.####.exr", number), frame, {});
  }
  expect_error(becalm({"denoise", folder_ / "in.####.exr", "-o", folder_ / "out.####.exr"}), kBadInput,
               {"in.####.exr: frames 1-3: no colour", "depth.Z"});
}

TEST_F(BadInput, UnknownSceneKey) {
  replace_in_scene("\"materials\"", "\"colour\": 1, \"materials\"");
  expect_error(render({}), kBadInput, {"scene.json", "/colour"});
}

TEST_F(BadInput, SceneSyntax) {
  replace_in_scene("\"materials\": {", "\"materials\": ");
  expect_error(render({}), kBadInput, {"scene.json"});
}

TEST_F(BadInput, MeshWithIndexOutOfRange) {
  write_text(folder_ / "broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n");
  replace_in_scene(R"({"shape": "sphere", "segments": 16})", R"({"obj": "broken.obj"})");
  expect_error(render({}), kBadInput, {"broken.obj", "7"});
}

TEST_F(BadInput, MaterialFilesAreCorrectedWithAWarning) {
  write_text(folder_ / "own.obj", "mtllib own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl r\x1b\nf 1 2 3\n");
  write_text(folder_ / "own.mtl", "newmtl r\x1b\nKd 2 0 0\n");
  write_text(scene_, R"({"camera": {"look_at": {"eye": [0, 0, 5], "target": [0, 0, 0]}}, "meshes": {
    "a": {"obj": "own.obj", "materials": "mtl"}, "b": {"obj": "own.obj", "materials": "mtl"}},
    "objects": [{"mesh": "a"}, {"mesh": "b"}]})");
  const std::string warning =
      "becalm: " + (folder_ / "own.mtl") +
      R"(: line 2: material 'r\x1b': Kd 2: expected a number from 0 to 1; taken as 1)" + "\n";
  EXPECT_EQ(becalm_done({"info", scene_}).err, warning) << "once";
  EXPECT_EQ(becalm_done(
                {"render", scene_, "-o", folder_ / "out.####.exr", "--spp", "1", "--size", "4x4", "--quiet"})
                .err,
            warning);
}

TEST_F(BadInput, DescendingRange) {
  expect_error(render({"--frames", "9-1"}), kUsage, {"9-1"});
}

TEST_F(BadInput, UnknownOption) {
  expect_error(render({"--spectral"}), kUsage, {"render", "--spectral"});
}

TEST_F(BadInput, MissingOutput) {
  expect_error(becalm({"render", scene_}), kUsage, {"-o"});
  expect_error(becalm({"denoise", scene_}), kUsage, {"--output"});
}

TEST_F(BadInput, NoSubcommand) {
  expect_error(becalm({}), kUsage, {"subcommand"});
}

TEST_F(BadInput, OutputFolderThatCannotBe) {
  expect_error(becalm({"render", scene_, "-o", scene_ + "/out.####.exr"}), kResource,
               {"scene.json/out.####.exr"});
  write_noise("in.0001.exr", 1);
  expect_error(becalm({"denoise", folder_ / "in.0001.exr", "-o", scene_ + "/out.exr"}), kResource,
               {"scene.json/out.exr"});
}

TEST_F(BadInput, OutputThatIsAFolder) {
  fs::create_directories(folder_ / "out.0001.exr");
  expect_error(render({"--frames", "1", "--quiet"}), kResource, {"out.0001.exr"});
}

TEST_F(BadInput, OutputWithoutFrameField) {
  expect_error(becalm({"render", scene_, "-o", folder_ / "out.exr"}), kUsage,
               {"out.exr", "4 frames", "####"});
}

TEST_F(BadInput, OutputOfAnotherFormat) {
  expect_error(becalm({"render", scene_, "-o", folder_ / "out.####.png"}), kUsage, {"out.####.png", ".exr"});
}

TEST_F(BadInput, OutputOverInput) {
  write_noise("in.0001.exr", 1);
  fs::create_directory_symlink(folder_.path(), folder_ / "link");
  for (const char* output : {"in.####.exr", "./in.%04d.exr", "link/in.####.exr"}) {
    expect_error(becalm({"denoise", folder_ / "in.####.exr", "-o", folder_ / output}), kUsage,
                 {"overwrite the input"});
  }
}

TEST_F(BadInput, HalvesThatAreNoPair) {
  for (const int number : {1, 2}) write_noise("in.000" + std::to_string(number) + ".exr", number);
  fs::create_symlink(folder_ / "in.0001.exr", folder_ / "other.exr");
  const auto denoise = [&](const std::string& first, const std::string& second) {
    return becalm({"denoise", folder_ / first, folder_ / second, "-o", folder_ / "out.####.exr"});
  };
  expect_error(denoise("in.####.exr", "in.####.exr"), kUsage, {"in.####.exr", "twice"});
  expect_error(denoise("in.0001.exr", "other.exr"), kUsage, {"in.0001.exr", "twice"});
  expect_error(denoise("in.0001.exr", "in.0002.exr"), kUsage,
               {"frames 1 and 2", "'" + folder_ / "in.####.exr" + "'"});
}

TEST_F(BadInput, ARangeThatIsNotTheSingleFile) {
  write_noise("in.0002.exr", 2);
  expect_error(becalm({"denoise", folder_ / "in.0002.exr", "-o", folder_ / "out.####.exr", "--frames", "7"}),
               kUsage, {"--frames 7", "is frame 2", "--frame 7"});
}

TEST_F(BadInput, AnEyeFieldWhereNoneIsTaken) {
  const std::string eyes = folder_ / "in.%V.####.exr";
  expect_error(becalm({"info", eyes, "--json"}), kUsage, {"%V", "left"});
  expect_error(becalm({"compare", eyes, eyes}), kUsage, {"%V", "left"});
  expect_error(becalm({"antialias", eyes, "-o", folder_ / "out.####.exr"}), kUsage, {"%V", "left"});
}

TEST_F(BadInput, ADryRunTellsThatNothingCanBeWritten) {
  write_noise("in.0001.exr", 1);
  expect_error(becalm({"denoise", folder_ / "in.0001.exr", "-o", scene_ + "/new/out.exr", "--dry-run"}),
               kResource, {"scene.json/new/out.exr"});
}

TEST_F(BadInput, ValuesOutOfRange) {
  expect_error(render({"--size", "640by360"}), kUsage, {"--size", "640by360", "WIDTHxHEIGHT"});
  expect_error(render({"--size", "0x360"}), kUsage, {"--size", "0x360"});
  expect_error(becalm({"render", scene_, "-o", folder_ / "o.####.exr", "--spp", "0"}), kUsage, {"--spp"});
  for (const char* seed : {"-1", "1.5", "4294967296", "x"})
    expect_error(render({"--seed", seed}), kUsage, {"--seed", seed, "from 0 to 4294967295"});
  for (const char* frame : {"1.5", "2147483648", "x"}) {
    expect_error(becalm({"denoise", folder_ / "in.exr", "-o", folder_ / "out.exr", "--frame", frame}), kUsage,
                 {"--frame", frame, "from -2147483648 to 2147483647"});
  }
  expect_error(render({"--aovs", "albedo,colour"}), kUsage, {"--aovs", "colour", "albedo"});
  expect_error(render({"--denoise=best"}), kUsage, {"best"});
  expect_error(render({"--denoise", "--set", "motion=far"}), kUsage, {"motion", "far"});
  expect_error(render({"--set", "motion=none"}), kUsage, {"--set", "--denoise"});
  expect_error(render({"--denoise", "--segment", "0"}), kUsage, {"--segment"});
  expect_error(render({"--denoise=draft", "--warmup", "4"}), kUsage, {"--warmup", "--segment"});
  expect_error(render({"--denoise", "--cuts", "often"}), kUsage, {"often"});
  expect_error(render({"--cuts", "5"}), kUsage, {"--cuts", "--denoise"});
  expect_error(render({"--debug-pixel", "1,2,0"}), kUsage, {"--debug-pixel"});
  expect_error(render({"--denoise", "--noise-target", "77"}), kUsage, {"--noise-target", "found 77"});
  expect_error(becalm({"compare", folder_ / "a.exr", folder_ / "b.exr", "--max-relmse", "1%"}), kUsage,
               {"--max-relmse", "found 1%"});
}

TEST_F(BadInput, NoSuchDevice) {
  expect_error(render({"--denoise", "--device", "no such device"}), kResource, {"no such device"});
}

TEST_F(BadInput, Memory) {
  for (const char* size : {"much", "5", "2X", "-1G", "1e3M", "nanG"}) {
    expect_error(render({"--denoise", "--memory", size}), kUsage, {"--memory", size, "512M"});
  }
  expect_error(render({"--memory", "1G"}), kUsage, {"--memory", "--denoise"});
  expect_error(render({"--denoise", "--cuts", "foo"}), kUsage, {"--cuts 'foo'"});
  expect_error(render({"--denoise", "--memory", "100K"}), kResource, {"48x32", "MiB"});
}

TEST_F(BadInput, LayerThatIsNotThere) {
  write_noise("in.0001.exr", 1);
  expect_error(
      becalm({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "out.exr", "--layers", "albedo=diffcol"}),
      kBadInput, {"in.0001.exr", "diffcol"});
}

TEST_F(BadInput, LayerThatOneFrameLacks) {
  write_noise("in.0001.exr", 1);
  Frame frame = noise_frame(2);
  frame.remove(Aov::albedo);
  io::write_exr(folder_ / "in.0002.exr", frame, {});
  expect_error(becalm({"denoise", folder_ / "in.####.exr", "-o", folder_ / "out.####.exr", "--quiet"}),
               kBadInput, {"in.0002.exr", "albedo", "in.0001.exr"});
  expect_error(becalm({"denoise", folder_ / "in.####.exr", "-o", folder_ / "out.####.exr", "--quiet",
                       "--preset", "draft"}),
               kBadInput, {"in.0002.exr", "albedo", "in.0001.exr"});
}

TEST_F(BadInput, ANumberBeyondFloatsIsToldTheirRange) {
  replace_in_scene("[8, 8, 7]", "1e308");
  expect_error(render({}), kBadInput, {"/objects/2/emission", "at most 3.4e38 in size, found 1e+308"});
}

TEST_F(BadInput, AWorkingDirectoryThatIsGoneIsTold) {
  fs::create_directories(folder_ / "gone");
  const Outcome outcome = Process({"render", scene_, "-o", "out.####.exr"},
                                  "cd '" + (folder_ / "gone") + "'; rmdir \"$PWD\"; exec \"$0\" \"$@\"")
                              .wait();
  expect_error(outcome, kResource, {"the working directory: No such file or directory"});
}

TEST_F(BadInput, AVariableThatNamesNoDriverIsTold) {
  for (const char* variable : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"}) {
    const Outcome outcome =
        Process({"info", "device"},
                fmt::format("unset VK_DRIVER_FILES; {}=/none.json exec \"$0\" \"$@\"", variable))
            .wait();
    expect_error(outcome, kResource, {std::string("found in ") + variable + "=/none.json"});
  }
}

}  // namespace
}  // namespace becalm::test
