// becalm test: what cases find, and what is reported.

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/end_to_end/suite_fixture.h"

namespace becalm::test {
namespace {

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    EXPECT_NE(text.find(word), std::string::npos) << word << "\nin: " << text;
  }
}

TEST_F(SuiteTest, ACaseThatIsEqualPassesAndOneThatDiffersFails) {
  write_suite(shell_case("same") + "," + shell_case("other"));
  update();
  EXPECT_EQ(run().status, 0);
  Frame frame = read_frame(folder_ / "references/other/a.0001.exr");
  float& value = frame.image(Aov::beauty).at(3, 2, 1);
  value = std::nextafter(value, 2.0f);
  io::write_exr(folder_ / "references/other/a.0001.exr", frame, {}, io::PixelType::float32);
  const Outcome outcome = run({"--report", folder_ / "report"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_EQ(files_in(folder_.path() / "report"), std::vector<std::string>{"index.html"});
  expect_words(line_of(outcome, "other"), {"failed", "exact", "1 pixels differ", "pixel 3,2", "1 ulp"});
  expect_words(line_of(outcome, "same"), {"passed"});
  expect_words(outcome.out, {"1 passed, 1 failed, 0 errors, 0 skipped"});
}

TEST_F(SuiteTest, ExactSeesChannelsThatBecalmDoesNotKnowAndEveryView) {
  const auto fails = [&](const char* name, const auto& change) {
    write_suite(shell_case(name));
    update();
    change(folder_ / (std::string("references/") + name + "/a.0001.exr"));
    const Outcome outcome = run();
    EXPECT_EQ(outcome.status, 1) << name;
    return line_of(outcome, name);
  };
  Frame left = noise_frame(1, kSize, kSize);
  Frame right = noise_frame(2, kSize, kSize);
  const auto write_views = [&](const std::string& path) {
    io::write_exr(path, std::vector<io::WrittenView>{{"left", &left}, {"right", &right}}, {},
                  io::PixelType::float32);
  };
  write_views(folder_ / "image.exr");
  const std::string eye = fails("eye", [&](const std::string& path) {
    right.image(Aov::beauty).at(1, 2, 0) += 1.0f;
    write_views(path);
  });
  expect_words(eye, {"right", "1 pixels differ", "pixel 1,2"});

  Frame group = noise_frame(1, kSize, kSize);
  group.light_groups().push_back({"key", Image(kSize, kSize, 3, 0.5f)});
  io::write_exr(folder_ / "image.exr", group, {});
  const std::string channel = fails("channel", [&](const std::string& path) {
    group.light_groups().front().radiance.at(3, 4, 1) = 0.25f;
    io::write_exr(path, group, {});
  });
  expect_words(channel, {"light.key.G", "1 pixels differ", "pixel 3,4"});
}

TEST_F(SuiteTest, MemoryThatBecalmTookIsNotACases) {
  constexpr int large = 1400;
  Frame frame(1, large, large);
  frame.add(Aov::beauty, 0.5f);
  io::write_exr(folder_ / "large.exr", frame, {});
  const std::string memory = R"(, "memory": "40M")";
  write_suite(shell_case("a_large", "cp large.exr $0") + "," +
              shell_case("b_small", "cp image.exr $0", memory));
  write_reference("b_small");
  update("a_large");
  EXPECT_EQ(run({"--filter", "b_small"}).status, 0);
  EXPECT_EQ(run().status, 0) << "becalm compared large frames before";
}

TEST_F(SuiteTest, UlpsMayBeAllowed) {
  write_suite(shell_case("other", "cp image.exr $0", "", R"("exact": {"max_ulps": 1})"));
  write_reference("other");
  EXPECT_EQ(run().status, 0);
  const Frame same = read_frame(folder_ / "image.exr", all_aovs());
  Frame frame = same;
  for (float& value : frame.image(Aov::beauty).data()) value = std::nextafter(value, 2.0f);
  io::write_exr(folder_ / "image.exr", frame, {}, io::PixelType::float32);
  EXPECT_EQ(run().status, 0);
  for (float& value : frame.image(Aov::beauty).data()) value = std::nextafter(value, 2.0f);
  io::write_exr(folder_ / "image.exr", frame, {}, io::PixelType::float32);
  EXPECT_EQ(run().status, 1);
  frame = same;
  frame.image(Aov::albedo).at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
  io::write_exr(folder_ / "image.exr", frame, {}, io::PixelType::float32);
  EXPECT_EQ(run({"--json", folder_ / "report.json"}).status, 1);
  expect_words(read_text(folder_ / "report.json"), {R"("value": "inf")"});
}

TEST_F(SuiteTest, HalvesDifferByUlpsOfHalfAndZerosBySign) {
  const auto write = [&](float first, float second) {
    Frame frame = noise_frame(1, kSize, kSize);
    frame.image(Aov::beauty).at(0, 0, 0) = first;
    frame.image(Aov::beauty).at(1, 0, 0) = second;
    io::write_exr(folder_ / "image.exr", frame, {});
  };
  write(0.0f, 1.0f);
  write_suite(shell_case("near", "cp image.exr $0", "", R"("exact": {"max_ulps": 4})") + "," +
              shell_case("same", "cp image.exr $0", "", R"("exact": true)"));
  for (const char* name : {"near", "same"}) write_reference(name);
  EXPECT_EQ(run().status, 0);
  write(0x1p-24f, 1.0f);
  EXPECT_EQ(run({"--filter", "near"}).status, 0);
  write(0x1p-24f, 1.5f);  // many ulps of float at 0, and of half at 1
  const Outcome far = run({"--filter", "near"});
  EXPECT_EQ(far.status, 1);
  expect_words(far.out, {"largest pixel 1,0", "512 ulps of half"});
  write(-0.0f, 1.0f);
  EXPECT_EQ(run({"--filter", "near"}).status, 0);
  EXPECT_EQ(run({"--filter", "same"}).status, 1);
}

TEST_F(SuiteTest, ReferencesKeepTheirPlaceAndLayersTheirName) {
  Imf::Header header(Imath::Box2i({0, 0}, {19, 19}), Imath::Box2i({3, 2}, {10, 7}));
  header.channels().insert("key.R", Imf::Channel(Imf::FLOAT));
  header.channels().insert("key.G", Imf::Channel(Imf::FLOAT));
  header.channels().insert("key.B", Imf::Channel(Imf::FLOAT));
  std::vector<float> values(static_cast<std::size_t>(20) * 20, 0.5f);
  Imf::FrameBuffer pixels;
  for (const char* name : {"key.R", "key.G", "key.B"}) {
    pixels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                   20 * sizeof(float)));
  }
  {
    Imf::OutputFile file((folder_ / "cropped.exr").c_str(), header);
    file.setFrameBuffer(pixels);
    file.writePixels(6);
  }
  write_suite(
      R"("cropped": {"source": {"command": ["sh", "-c", "cp cropped.exr $0", "{output}", "{seed}"]}, "layer": "key",
    "judged_by": {"error": {"max_rel_mse": 1e-5}}})");
  update();
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 0) << outcome.out;
}

TEST_F(SuiteTest, ACaseWithoutReferenceIsAnError) {
  write_suite(shell_case("good") + "," + shell_case("none"));
  write_reference("good");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 3);
  expect_words(line_of(outcome, "none"), {"error", "references/none/a.0001.exr", "--update=suite/none"});
  expect_words(line_of(outcome, "good"), {"passed"});
}

TEST_F(SuiteTest, ADamagedReferenceIsAnError) {
  write_suite(shell_case("damaged"));
  write_reference("damaged");
  fs::resize_file(folder_ / "references/damaged/a.0001.exr", 600);
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 3);
  expect_words(line_of(outcome, "damaged"), {"error", "references/damaged/a.0001.exr"});
}

TEST_F(SuiteTest, WhatGoesWrongInOneCaseFailsThatCaseAlone) {
  Frame frame = noise_frame(1, kSize, kSize);
  frame.image(Aov::beauty).at(5, 4, 0) = std::numeric_limits<float>::quiet_NaN();
  io::write_exr(folder_ / "nan.exr", frame, {});
  io::write_exr(folder_ / "small.exr", noise_frame(1, 8, 8), {});
  write_suite(shell_case("a_crash", "kill -SEGV $$") + "," +
              shell_case("b_timeout", "sleep 30", R"(, "timeout_s": 0.2)") + "," +
              shell_case("c_nan", "cp nan.exr $0") + "," +
              shell_case("d_memory", "head -c 200M /dev/zero | tail -c 200M >/dev/null; cp image.exr $0 #",
                         R"(, "memory": "40M")") +
              "," + shell_case("e_status", "echo no licence >&2; exit 7") + "," +
              shell_case("f_nothing", "true") + "," + shell_case("g_size", "cp small.exr $0") + "," +
              shell_case("h_text", "echo text >$0") + "," + shell_case("i_good"));
  for (const char* name :
       {"a_crash", "b_timeout", "c_nan", "d_memory", "e_status", "f_nothing", "g_size", "h_text", "i_good"}) {
    write_reference(name);
  }
  const Outcome outcome =
      run({"--junit", folder_ / "junit.xml", "--json", folder_ / "results.json", "--jobs", "2"});
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  expect_words(line_of(outcome, "a_crash"), {"failed", "crashed", "signal 11"});
  expect_words(line_of(outcome, "b_timeout"), {"failed", "timed out after 0.2 s"});
  expect_words(line_of(outcome, "c_nan"), {"failed", "frame 1", "1 pixels are not finite", "pixel (5, 4)"});
  expect_words(line_of(outcome, "d_memory"), {"failed", "MiB of memory", "40 MiB"});
  expect_words(line_of(outcome, "e_status"), {"failed", "exit status 7: no licence"});
  expect_words(line_of(outcome, "f_nothing"), {"failed", "frame 1 was not written"});
  expect_words(line_of(outcome, "g_size"), {"failed", "8x8", "16x16"});
  expect_words(line_of(outcome, "h_text"), {"failed", "frame.0001.exr"});
  expect_words(line_of(outcome, "i_good"), {"passed"});

  boost::property_tree::ptree junit;
  boost::property_tree::read_xml(folder_ / "junit.xml", junit);
  EXPECT_EQ(junit.get<int>("testsuites.<xmlattr>.tests"), 9);
  EXPECT_EQ(junit.get<int>("testsuites.testsuite.<xmlattr>.failures"), 8);
  EXPECT_EQ(junit.get<int>("testsuites.testsuite.<xmlattr>.errors"), 0);
  EXPECT_EQ(junit.get<std::string>("testsuites.testsuite.<xmlattr>.name"), "suite");
  EXPECT_GT(junit.get<double>("testsuites.<xmlattr>.time"), 0.1);
  const auto& cases = junit.get_child("testsuites.testsuite");
  EXPECT_EQ(cases.count("testcase"), 9u);
  int failures = 0;
  for (const auto& [key, element] : cases) failures += static_cast<int>(element.count("failure"));
  EXPECT_EQ(failures, 8);

  const auto json = nlohmann::json::parse(read_text(folder_ / "results.json"));
  EXPECT_EQ(json["failed"], 8);
  EXPECT_EQ(json["cases"][8]["outcome"], "passed");
  EXPECT_EQ(json["cases"][8]["checks"][0]["judge"], "exact");
  expect_words(json["cases"][4]["output"].get<std::string>(), {"no licence"});
  expect_words(json["cases"][4]["command"].get<std::string>(), {"sh -c"});
}

TEST_F(SuiteTest, FilterShardListAndFailFastChooseCases) {
  write_suite(shell_case("apple", "exit 1") + "," + shell_case("banana") + "," + shell_case("cherry"));
  for (const char* name : {"apple", "banana", "cherry"}) write_reference(name);
  EXPECT_EQ(run({"--list"}).out, "suite/apple\nsuite/banana\nsuite/cherry\n");
  EXPECT_EQ(run({"--list", "--filter", "suite/b*"}).out, "suite/banana\n");
  EXPECT_EQ(run({"--list", "--shard", "1/2"}).out, "suite/apple\nsuite/cherry\n");
  EXPECT_EQ(run({"--list", "--shard", "2/2"}).out, "suite/banana\n");
  EXPECT_EQ(run({"--filter", "[bc]*"}).status, 0);
  const Outcome fast = run({"--fail-fast", "--junit", folder_ / "junit.xml"});
  EXPECT_EQ(fast.status, 1);
  expect_words(fast.out, {"0 passed, 1 failed, 0 errors, 2 skipped"});
  boost::property_tree::ptree junit;
  boost::property_tree::read_xml(folder_ / "junit.xml", junit);
  EXPECT_EQ(junit.get<int>("testsuites.<xmlattr>.skipped"), 2);
  expect_error(run({"--filter", "pear"}), 2, {"--filter pear", "3 cases"});
  expect_error(run({"--shard", "3/2"}), 2, {"--shard 3/2", "I/N"});
}

TEST_F(SuiteTest, CasesAfterAnErrorThatEndsTheRunSaySo) {
  const std::string without_folder = "rm -r kept/suite; touch kept/suite; exit 1";
  write_suite(shell_case("a", without_folder) + "," + shell_case("b") + "," + shell_case("c"));
  for (const char* name : {"a", "b", "c"}) write_reference(name);
  const Outcome outcome = run({"--keep", folder_ / "kept"});
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  expect_words(outcome.err, {"kept/suite/b: cannot make the folder"});
  expect_words(line_of(outcome, "c"), {"skipped", "an error ended the run"});
}

TEST_F(SuiteTest, ACommandIsTold) {
  write_suite(shell_case("told", "cp image.exr $0; echo $0 {frame} {spp} {seed} {threads} >>told.txt",
                         R"(, "frames": "1-2", "spp": 3, "seed": 5)"));
  write_reference("told");
  fs::copy_file(folder_ / "image.exr", folder_ / "references/told/a.0002.exr");
  EXPECT_EQ(run({"--threads", "1", "--keep", folder_ / "kept"}).status, 0);
  const std::string frames = folder_ / "kept/suite/told/test/frame.";
  EXPECT_EQ(read_text(folder_ / "told.txt"), frames + "0001.exr 1 3 5 1\n" + frames + "0002.exr 2 3 5 1\n");
  EXPECT_TRUE(fs::exists(frames + "0002.exr"));
  EXPECT_EQ(run({"--threads", "1", "--keep", folder_ / "kept"}).status, 0) << "its own are replaced";
  const std::string precious = folder_ / "mine/suite/told/precious.txt";
  fs::create_directories(fs::path(precious).parent_path());
  std::ofstream(precious) << "precious";
  const Outcome refused = run({"--keep", folder_ / "mine"});
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_TRUE(fs::exists(precious));
}

TEST_F(SuiteTest, ACommandWithoutFrameMakesASequence) {
  write_suite(shell_case("all", "for f in 0001 0002; do cp image.exr ${0%####.exr}$f.exr; done",
                         R"(, "frames": "1-2")"));
  write_reference("all");
  fs::copy_file(folder_ / "image.exr", folder_ / "references/all/a.0002.exr");
  EXPECT_EQ(run().status, 0);
}

TEST_F(SuiteTest, CommandsReadWhatWasPrepared) {
  write_suite(R"("two_steps": {"source": {"frames": "1-2", "spp": 1, "seed": 5,
    "prepare": [["{becalm}", "render", "scene.json", "-o", "{work}/in.####.exr", "--frames", "1-2", "--spp", "{spp}",
                 "--seed", "{seed}", "--float", "--quiet"],
                ["sh", "-c", "echo $0 $(ls {work}) >>told.txt", "{frame}"]],
    "command": ["cp", "{work}/in.000{frame}.exr", "{output}"]}, "judged_by": {"exact": true}})");
  update();
  EXPECT_EQ(read_text(folder_ / "told.txt"), "1 in.0001.exr in.0002.exr\n2 in.0001.exr in.0002.exr\n");
  becalm_done({"render", folder_ / "scene.json", "-o", folder_ / "rendered.####.exr", "--frames", "1-2",
               "--spp", "1", "--seed", "5", "--float", "--quiet"});
  expect_same_beauty(folder_ / "references/two_steps/a.####.exr", folder_ / "rendered.####.exr", 1, 2);
  const Outcome outcome = run({"--json", folder_ / "results.json"});
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  expect_words(read_text(folder_ / "results.json"), {"becalm render", " && sh -c", " && cp "});
}

TEST_F(SuiteTest, WhatACommandPrintsLastIsSafeForTerminals) {
  write_suite(shell_case("a", "printf '\\\\033[31mred\\\\r\\\\n'; exit 7"));
  write_reference("a");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 1);
  expect_words(line_of(outcome, "a"), {R"(exit status 7: \x1b[31mred)"});
  EXPECT_EQ(outcome.out.find_first_of("\033\r"), std::string::npos) << outcome.out;
}

TEST_F(SuiteTest, WhatCannotBePreparedFailsTheCase) {
  write_suite(
      shell_case("a", "cp image.exr $0", R"(, "prepare": [["sh", "-c", "echo no licence; exit 7"]])"));
  write_reference("a");
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 1);
  expect_words(line_of(outcome, "a"), {"failed", "exit status 7: no licence"});
}

TEST_F(SuiteTest, ReferencesMayHaveACommandOfTheirOwn) {
  write_image("truth.exr", 2);
  write_suite(R"("filtered": {"source": {"command": ["cp", "{work}/in.exr", "{output}"], "prepare": [
    ["cp", "image.exr", "{work}/in.exr"]]}, "reference": {"command": ["cp", "truth.exr", "{output}"]},
    "judged_by": {"error": {"max_rel_mse": 1e-5}}})");
  update();
  const Outcome outcome = run();
  EXPECT_EQ(outcome.status, 1);
  expect_words(line_of(outcome, "filtered"), {"failed", "relMSE"});
  write_image("image.exr", 2);
  EXPECT_EQ(run().status, 0);
}

TEST_F(SuiteTest, WorkingFilesAreRemoved) {
  write_suite(shell_case("good"));
  write_reference("good");
  fs::create_directories(folder_ / "tmp");
  const Outcome outcome =
      Process({"test", suite_}, "TMPDIR='" + (folder_ / "tmp") + "' exec \"$0\" \"$@\"").wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(files_in(folder_.path() / "tmp").empty());
}

TEST_F(SuiteTest, AWorkFolderThatCannotBeMadeIsNamedWhole) {
  write_suite(shell_case("good"));
  const std::string missing = folder_ / "missing";
  const Outcome outcome = Process({"test", suite_}, "TMPDIR='" + missing + "' exec \"$0\" \"$@\"").wait();
  expect_error(outcome, 4, {missing + "/becalm_test_", ": cannot make the folder", "TMPDIR"});
}

}  // namespace
}  // namespace becalm::test
