// becalm test: mistakes in suite files, one line each with the place, the value and what was expected.

#include <gtest/gtest.h>

#include "tests/end_to_end/suite_fixture.h"

namespace becalm::test {
namespace {

struct Mistake {
  const char* json;
  std::vector<std::string> words;
};

TEST_F(SuiteTest, MistakesAreToldWithTheirPlace) {
  const std::vector<Mistake> mistakes{
      {R"({"case": {}})", {"/case: unknown key", "defaults, cases"}},
      {R"({"cases": {}})", {"/cases", "at least one case"}},
      {R"({"cases": {"a/b": {}}})", {"/cases/a~1b", "a name of letters"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json\u0000"}}}})",
       {"/cases/a/source/scene", "\\u0000"}},
      {R"({"cases": {"a": {"sauce": 1}}})", {"/cases/a/sauce: unknown key", "source"}},
      {R"({"cases": {"a": {"source": {"scene": "none.json"}}}})", {"/cases/a/source/scene", "none.json"}},
      {R"({"cases": {"a": {"source": {"spp": 1}}}})", {"/cases/a/source", "'scene' or a 'command'"}},
      {R"({"cases": {"a": {"source": {"command": []}}}})", {"/cases/a/source/command", "a program"}},
      {R"({"cases": {"a": {"source": {"command": ["x"]}}}})", {"/cases/a/source/command", "{output}"}},
      {R"({"cases": {"a": {"source": {"command": ["x", "{output}"], "size": "1x1"}}}})",
       {"/cases/a/source/size", "is for a scene"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "command": ["x", "{output}"]}}}})",
       {"/cases/a/source/command", "found both"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "prepare": [["x"]]}}}})",
       {"/cases/a/source/prepare", "is for a command"}},
      {R"({"cases": {"a": {"source": {"command": ["x", "{output}"], "prepare": ["x"]}}}})",
       {"/cases/a/source/prepare/0", "list"}},
      {R"({"cases": {"a": {"source": {"command": ["x", "{output}"], "prepare": [["x"], []]}}}})",
       {"/cases/a/source/prepare/1", "a program"}},
      {R"({"cases": {"a": {"source": {"command": ["x", "{output}"], "prepare": [["x", "{output}"]]}}}})",
       {"/cases/a/source/prepare/0", "{work}"}},
      {R"({"cases": {"a": {"reference": {"command": ["x"]}}}})", {"/cases/a/reference/command", "{output}"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "frames": "9-1"}}}})",
       {"/cases/a/source/frames", "9-1"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "spp": 0}}}})",
       {"/cases/a/source/spp", "from 1 to 65536", "found 0"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "memory": "lots"}}}})",
       {"/cases/a/source/memory", "512M", "lots"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "denoise": "best"}}}})",
       {"/cases/a/source/denoise", "balanced", "best"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}}}})", {"/cases/a", "at least one judge"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}, "judged_by": {"exact": true, "statistical": true}}}})",
       {"/cases/a", "exclude each other"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}, "judged_by": {"error": {"max_flip": 1}}}}})",
       {"/cases/a/judged_by/error/max_flip: unknown key", "max_rel_mse"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}, "judged_by": {"error": {}}}}})",
       {"/cases/a/judged_by/error", "at least one limit"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}, "judged_by": {"perceptual": {"max_flip": -1}}}}})",
       {"/cases/a/judged_by/perceptual/max_flip", "at least 0", "-1"}},
      {R"({"cases": {"a": {"judged_by": {"perceptual": {"min_ssim": 2}}}}})",
       {"/cases/a/judged_by/perceptual/min_ssim", "at most 1", "found 2"}},
      {R"({"cases": {"a": {"judged_by": {"denoised": {"max_flip": 5}}}}})",
       {"/cases/a/judged_by/denoised/max_flip", "at most 1", "found 5"}},
      {R"({"cases": {"a": {"judged_by": {"error": {"max_energy": -1}}}}})",
       {"/cases/a/judged_by/error/max_energy", "at least 0"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "size": "0x0"}}}})",
       {"/cases/a/source/size", "0x0", "WIDTHxHEIGHT"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "size": ""}}}})",
       {"/cases/a/source/size", "WIDTHxHEIGHT"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "aovs": ["albedo", "x"]}}}})",
       {"/cases/a/source/aovs", "no AOV 'x'", "light_groups"}},
      {R"({"defaults": {"source": {"aovs": ["flow"]}}, "cases": {}})",
       {"/defaults/source/aovs", "no AOV 'flow' of the tracer"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}, "judged_by": {"sequence": {"max_flicker": 1}}}}})",
       {"/cases/a", "frames that follow each other"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json", "denoise": "draft"}, "judged_by": {"statistical": true}}}})",
       {"/cases/a", "not denoised"}},
      {R"({"cases": {"a": {"source": {"command": ["x", "{output}"]}, "reference": {"denoise": "draft"}, "judged_by": {"exact": true}}}})",
       {"/cases/a/reference/denoise", "a command makes these"}},
      {R"({"defaults": {"reference": {"denoise": "draft"}}, "cases": {"a": {"source": {"command": ["x", "{output}"]}, "judged_by": {"exact": true}}}})",
       {"/cases/a", "'denoise'", "a command makes these"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}, "reference": {"command": ["x", "{output}"]}, "judged_by": {"statistical": true}}}})",
       {"/cases/a/reference/command", "'spp' beside it", "{spp}"}},
      {R"({"cases": {"a": {"source": {"scene": "scene.json"}, "reference": {"spp": 1}, "judged_by": {"statistical": true}}}})",
       {"/cases/a/reference/spp", "two samples"}},
      {R"({"cases": {"a": {"source": {"command": ["x", "{output}"], "spp": 1}, "judged_by": {"statistical": true}}}})",
       {"/cases/a:", "two samples"}},
      {R"({"cases": {"a": {"reference": {"count": 3}}}})", {"/cases/a/reference/count", "from 1 to 2"}},
      {R"({"cases": {"a": {"false_alarm_rate": 2}}})", {"/cases/a/false_alarm_rate", "2"}},
      {R"({"defaults": {"source": {"sppp": 2}}, "cases": {}})", {"/defaults/source/sppp: unknown key"}},
      {R"({"cases": )", {"suite.json:1:"}},
  };
  for (const Mistake& mistake : mistakes) {
    write_text(suite_, mistake.json);
    std::vector<std::string> words = mistake.words;
    words.emplace_back("suite.json");
    expect_error(run(), 3, words);
  }
}

TEST_F(SuiteTest, NamesThatNoFileSystemCanHaveAreRefused) {
  const std::string name(300, 'x');
  write_suite(shell_case(name));
  expect_error(run(), 3, {"suite.json: /cases/" + name, "at most 200"});
  write_suite(R"("a": {"source": {"scene": ")" + name + R"("}})");
  expect_error(run(), 3, {"suite.json: /cases/a/source/scene: no file"});
  expect_error(becalm({"test", name}), 3, {name, "no such suite file"});
}

TEST_F(SuiteTest, DefaultsOfScenesAreNotForCasesOfACommand) {
  const std::string defaults = R"({"source": {"size": "8x8", "aovs": ["albedo"], "denoise": "draft"}})";
  const char* judge = R"("statistical": true, "error": {"max_rel_mse": 1})";
  write_suite(shell_case("a", "cp image.exr $0; # {seed}", R"(, "spp": 4)", judge), defaults);
  EXPECT_EQ(run({"--list"}).status, 0) << run({"--list"}).err;
  write_suite(shell_case("a", "cp image.exr $0; # {seed}", R"(, "spp": 4, "denoise": "draft")", judge),
              defaults);
  expect_error(run({"--list"}), 3, {"/cases/a/source/denoise", "is for a scene"});
}

TEST_F(SuiteTest, SuitesThatAreNotThereAreTold) {
  expect_error(becalm({"test", folder_ / "none.json"}), 3, {"none.json", "no such suite"});
  fs::create_directories(folder_ / "empty");
  expect_error(becalm({"test", folder_ / "empty"}), 3, {"empty", "no suite"});
}

TEST_F(SuiteTest, SuitesArePlainFiles) {
  write_suite(shell_case("a"));
  expect_error(becalm_redirected({"test", "/dev/stdin"}, "< <(cat '" + suite_ + "')"), 3,
               {"/dev/stdin: not a file, expected a JSON file"});
}

TEST_F(SuiteTest, CasesOfTwoSuitesMayNotShareReferences) {
  write_suite(shell_case("same"));
  fs::copy_file(suite_, folder_ / "suite2.json");
  fs::remove(folder_ / "scene.json");
  expect_error(becalm({"test", folder_.path().string()}), 3,
               {"suite2.json", "/cases/same", "references/same"});
}

TEST_F(SuiteTest, SuitesOfOneNameAreToldApartByTheirFolders) {
  const std::string kept = folder_ / "kept";
  std::vector<std::string> command{"test", "--jobs", "2", "--keep", kept};
  for (const char* name : {"glass", "metal"}) {
    const fs::path place = folder_.path() / name;
    fs::create_directories(place);
    write_text(
        (place / "suite.json").string(),
        fmt::format("{{\"cases\": {{{}}}}}", shell_case("same", fmt::format("cp ../{}.exr $0", name))));
    write_image(fmt::format("{}.exr", name), name[0]);
    fs::create_directories(place / "references/same");
    fs::copy_file(folder_ / fmt::format("{}.exr", name), place / "references/same/a.0001.exr");
    command.push_back((place / "suite.json").string());
  }
  const Outcome outcome = becalm(command);
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  for (const char* name : {"glass", "metal"}) {
    EXPECT_NE(outcome.out.find(fmt::format(" {}.suite/same", name)), std::string::npos) << outcome.out;
    EXPECT_TRUE(fs::exists(fmt::format("{}/{}.suite/same/test/frame.0001.exr", kept, name)));
  }
  command.insert(command.end(), {"--list", "--filter", "metal*"});
  EXPECT_EQ(becalm(command).out, "metal.suite/same\n");
}

TEST_F(SuiteTest, NamesOfSuitesDoNotTellWhereTheirCommonFolderLies) {
  fs::create_directories(folder_ / "inner/deep");
  const std::vector<std::string> files{suite_, folder_ / "inner/deep/suite.json",
                                       folder_ / "inner/other.json"};
  for (const std::string& file : files)
    write_text(file, fmt::format("{{\"cases\": {{{}}}}}", shell_case(fs::path(file).stem())));
  EXPECT_EQ(becalm({"test", "--list", files[0], files[1], files[2]}).out,
            "suite/suite\ninner.deep.suite/suite\nother/other\n");
  const std::string same = folder_ / "inner/inner.deep.suite.json";
  fs::copy_file(files[2], same);
  expect_error(becalm({"test", "--list", files[0], files[1], same}), 3, {"inner.deep.suite", "rename one"});
}

TEST_F(SuiteTest, DefaultsHoldForAllCasesUnlessTheyChangeThem) {
  write_suite(R"("a": {}, "b": {"judged_by": {"exact": false, "error": {"max_rel_mse": 0}}})",
              R"({"source": {"command": ["cp", "image.exr", "{output}"]}, "judged_by": {"exact": true}})");
  for (const char* name : {"a", "b"}) write_reference(name);
  const Outcome outcome = run({"--json", folder_ / "results.json"});
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  const std::string json = read_text(folder_ / "results.json");
  EXPECT_NE(json.find("\"judge\": \"exact\""), std::string::npos);
  EXPECT_NE(json.find("\"judge\": \"error\""), std::string::npos);
}

}  // namespace
}  // namespace becalm::test
