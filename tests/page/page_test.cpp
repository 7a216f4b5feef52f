#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "app/test/test_page.h"
#include "frame/io/exr.h"
#include "tests/io/temporary_folder.h"

namespace becalm::app {
namespace {

namespace fs = std::filesystem;

/// A lit ball before a wall, with noise of that many samples; `brightness` is the ball's.
Frame ball(int number, double brightness, int samples, int width = 256, int height = 144) {
  std::mt19937 random(static_cast<unsigned>(number + 100 * samples));
  Frame frame(number, width, height);
  frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::variance);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x - 0.5 * width + 12.0 * number) / (0.3 * height);
      const double v = (y - 0.55 * height) / (0.3 * height);
      const double height_of_ball = 1.0 - u * u - v * v;
      const double light =
          height_of_ball > 0.0
              ? brightness * (0.1 + 0.9 * std::max(0.0, std::sqrt(height_of_ball) - 0.4 * (u + v)))
              : 0.08 + 0.1 * (1.0 - static_cast<double>(y) / height);
      const std::array<double, 3> tint{1.0, 0.75, 0.5};
      for (int c = 0; c < 3; ++c) {
        const double value = 0.2 * tint[height_of_ball > 0.0 ? c : 2 - c] * light;
        const double uniform = (static_cast<double>(random() >> 8) * 0x1p-24 - 0.5) * std::sqrt(12.0);
        frame.image(Aov::beauty).at(x, y, c) =
            static_cast<float>(value * (1.0 + 0.5 * uniform / std::sqrt(samples)));
        frame.image(Aov::variance).at(x, y, c) = static_cast<float>(0.25 * value * value / samples);
      }
    }
  }
  return frame;
}

/// Frames of cases, and the page that shows them.
class Page : public testing::Test {
 protected:
  std::string write(const std::string& name, const Frame& frame) {
    const std::string path = folder_.path(name);
    io::write_exr(path, frame, {}, io::PixelType::float32);
    return path;
  }

  JudgedFrame pair(int number, double brightness) {
    const std::string name = fmt::format("{}.{}.exr", number, brightness);
    return {.number = number,
            .test = write("test." + name, ball(number, brightness, 16)),
            .reference = write("reference." + name, ball(number, 1.0, 1024)),
            .reference_b = {},
            .denoised_test = {},
            .denoised_reference = {}};
  }

  CaseResult failed_case() {
    CaseResult result = named("ball moves", CaseOutcome::failed);
    result.messages = {
        "block of 32x32 pixels at 96,48, channel 0: 0.0912 instead of 0.0868, z +31.40, threshold 5.14, p 0",
        "relMSE of frame 2 is 3.1200e-03, and max_relmse is 0.002 (1 of 3 frames)"};
    result.checks = {check("statistical", "z", 2, 31.4, 5.14, false),
                     check("error", "relMSE", 2, 3.12e-3, 2e-3, false),
                     check("perceptual", "FLIP", 3, 0.031, 0.05, true)};
    result.frames = {pair(1, 1.0), pair(2, 1.06), pair(3, 1.0)};
    result.command =
        "/usr/bin/becalm render scenes/ball.json -o frames/ball.####.exr --frames=1-3 --spp 16 --seed 1";
    result.output =
        "becalm: frame 1 of 3\nbecalm: frame 2 of 3\nbecalm: warning: </script><b>not markup</b>\n";
    result.seconds = 12.3;
    result.peak_memory_bytes = 310u << 20;
    return result;
  }

  static CaseResult named(const std::string& name, CaseOutcome outcome) {
    CaseResult result;
    result.suite = "balls";
    result.suite_file = "tests/regression/balls.json";
    result.name = name;
    result.outcome = outcome;
    result.seconds = 4.2;
    return result;
  }

  static CheckResult check(const char* judge, const char* figure, int frame, double value, double limit,
                           bool passed) {
    return {.judge = judge,
            .figure = figure,
            .frame = frame,
            .value = value,
            .limit = limit,
            .passed = passed,
            .text = {}};
  }

  /// A failed case after a passed one, one that crashed, one of another size, and 20 that passed.
  TestResults results() {
    TestResults results{.cases = {}, .seconds = 95.0};
    const auto passed = [&](int number) {
      CaseResult result = named(fmt::format("passes_{:02}", number), CaseOutcome::passed);
      result.checks = {check("statistical", "z", 1, 2.0 + 0.1 * number, 5.14, true)};
      results.cases.push_back(result);
    };
    passed(0);
    results.cases.push_back(failed_case());
    CaseResult crashed = named("crashes", CaseOutcome::failed);
    crashed.messages = {"renderer was ended by signal 11 (Segmentation fault): loading textures/brick.png"};
    crashed.command = "renderer crash.scene";
    crashed.output = "loading crash.scene\nloading textures/brick.png\n";
    results.cases.push_back(crashed);
    CaseResult other_size = named("other_size", CaseOutcome::error);
    other_size.messages = {"frame 1 is 64x36, and its reference 256x144"};
    other_size.frames = {pair(1, 1.0)};
    other_size.frames[0].test = write("small.exr", ball(1, 1.0, 16, 64, 36));
    results.cases.push_back(other_size);
    results.cases.push_back(named("left_out", CaseOutcome::skipped));
    for (int number = 1; number < 20; ++number) passed(number);
    return results;
  }

  static nlohmann::json data_of(const std::string& page) {
    const std::string start = "<script type=\"application/json\" id=\"data\">";
    const std::size_t from = page.find(start) + start.size();
    return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  }

  fs::path folder() const { return folder_.path(""); }

 private:
  io::TemporaryFolder folder_;
};

TEST_F(Page, HoldsPicturesOfTheFramesThatFailed) {
  const nlohmann::json failed = data_of(test_page(results())).at("cases").at(1);
  EXPECT_EQ(failed.at("name"), "balls/ball moves");
  ASSERT_EQ(failed.at("frames").size(), 1u) << "frames 1 and 3 failed no check that could fail";
  EXPECT_EQ(failed.at("frames").at(0).at("number"), 2);
  for (const char* kind : {"reference", "result", "difference", "z-scores"}) {
    EXPECT_EQ(failed.at("frames")
                  .at(0)
                  .at("pictures")
                  .at(kind)
                  .get<std::string>()
                  .rfind("data:image/png;base64,iVBOR", 0),
              0u)
        << kind;
  }
  EXPECT_EQ(failed.at("replay"), "becalm test tests/regression/balls.json --filter 'balls/ball moves'");
  EXPECT_EQ(failed.at("frame_count"), 3);
}

TEST_F(Page, HoldsPicturesOfFramesThatCouldNotBeJudged) {
  TestResults results{.cases = {named("a", CaseOutcome::failed)}, .seconds = 1.0};
  for (int number = 1; number <= 6; ++number) results.cases[0].frames.push_back(pair(number, 1.0));
  results.cases[0].unjudged = {6};
  const nlohmann::json frames = data_of(test_page(results)).at("cases").at(0).at("frames");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames.at(0).at("number"), 6);
}

TEST_F(Page, ShowsTheLayerThatWasJudged) {
  TestResults results{.cases = {named("a", CaseOutcome::failed)}, .seconds = 1.0};
  results.cases[0].layer = "albedo";
  results.cases[0].frames = {pair(1, 1.0)};
  const Frame reference = ball(1, 1.0, 1024);
  Frame frame(1, reference.width(), reference.height());
  frame.add(Aov::beauty, 1.0f);
  Image& albedo = frame.add(Aov::albedo);
  for (std::size_t i = 0; i < albedo.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      albedo.data()[3 * i + c] = reference.image(Aov::beauty).data()[4 * i + c];
  }
  results.cases[0].frames[0].test = write("albedo.exr", frame);
  const nlohmann::json pictures =
      data_of(test_page(results)).at("cases").at(0).at("frames").at(0).at("pictures");
  EXPECT_EQ(pictures.at("result"), pictures.at("reference"));
}

TEST_F(Page, SaysWhatCannotBePictured) {
  TestResults results{.cases = {named("a", CaseOutcome::error)}, .seconds = 1.0};
  std::ofstream(folder() / "broken.exr") << "no picture";
  results.cases[0].frames = {pair(1, 1.0), pair(2, 1.0), pair(3, 1.0)};
  results.cases[0].frames[0].test = (folder() / "broken.exr").string();
  results.cases[0].frames[1].reference.clear();
  results.cases[0].frames[2].test.clear();
  const nlohmann::json frames = data_of(test_page(results)).at("cases").at(0).at("frames");
  EXPECT_NE(frames.at(0).at("note").get<std::string>().find("broken.exr"), std::string::npos);
  EXPECT_EQ(frames.at(1).at("note"), "there is no reference");
  EXPECT_TRUE(frames.at(1).at("pictures").contains("result"));
  EXPECT_EQ(frames.at(2).at("note"), "this frame was not made");
  EXPECT_TRUE(frames.at(2).at("pictures").contains("reference"));
}

TEST_F(Page, TakesFiguresAndTextThatJsonAndHtmlDoNot) {
  TestResults results{.cases = {named("a", CaseOutcome::failed)}, .seconds = 1.0};
  results.cases[0].checks = {
      check("error", "PSNR", 1, std::numeric_limits<double>::infinity(), 30.0, true),
      check("error", "relMSE", 1, std::numeric_limits<double>::quiet_NaN(), 0.1, false)};
  results.cases[0].output = "\xff is no UTF-8, </script><!-- is no end";
  const std::string page = test_page(results);
  const nlohmann::json shown = data_of(page).at("cases").at(0);
  EXPECT_EQ(shown.at("checks").at(0).at("value"), "inf");
  EXPECT_TRUE(shown.at("checks").at(1).at("value").is_null());
  EXPECT_NE(shown.at("output").get<std::string>().find("is no UTF-8, </script><!-- is no end"),
            std::string::npos);
}

TEST_F(Page, NeedsNothingFromElsewhere) {
  const std::string page = test_page(results());
  for (const char* word : {"http:", "https:", "src=\"", "url(", "@import", "<link"}) {
    EXPECT_EQ(page.find(word), std::string::npos) << word;
  }
}

/// What the page itself finds once it is laid out.
constexpr const char* kProbe = R"(<script>
addEventListener("error", (event) => { document.documentElement.dataset.problem = event.message; });
addEventListener("load", () => {
  const viewers = [...document.querySelectorAll(".viewer")];
  const broken = [...document.querySelectorAll(".viewer img")].filter((image) => image.naturalWidth === 0).length;
  const divider = document.querySelector(".divider");
  divider.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true, cancelable: true }));
  for (const button of document.querySelectorAll(".viewing button")) if (!button.disabled) button.click();
  const unnamed = [...document.querySelectorAll("button, select, [role=slider], [role=img]")].filter(
    (element) => !element.textContent.trim() && !element.ariaLabel);
  const report = {
    inner_width: innerWidth, width: document.documentElement.scrollWidth, viewers: viewers.length,
    narrowest: Math.min(...viewers.map((viewer) => viewer.clientWidth)), split: divider.getAttribute("aria-valuenow"),
    first: document.querySelector("section h2").textContent, unnamed: unnamed.length, broken,
    unreachable: [...document.querySelectorAll(".divider")].filter((element) => element.tabIndex < 0).length,
    problem: document.documentElement.dataset.problem ?? "",
  };
  if (parent !== window) parent.postMessage(report, "*");
});
</script>)";

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  for (int c; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  if (pipe != nullptr) pclose(pipe);
  return text;
}

class PageAtWidth : public Page, public testing::WithParamInterface<std::array<int, 2>> {};

/// In a frame of that size, since a window cannot be as narrow as a phone.
TEST_P(PageAtWidth, IsLaidOutWithoutErrorsOrSidewaysScrolling) {
  ASSERT_EQ(std::system("command -v chromium >/dev/null"), 0) << "scripts/test installs chromium";
  const auto [width, height] = GetParam();
  std::string page = test_page(results());
  page.insert(page.find("<style>"), kProbe);
  std::ofstream(folder() / "page.html") << page;
  std::ofstream(folder() / "frame.html") << fmt::format(
      "<!doctype html><style>body {{ margin: 0 }} iframe {{ border: 0; width: {}px; height: {}px "
      "}}</style><pre id=report></pre>"
      "<script>addEventListener('message', (e) => {{ report.textContent = JSON.stringify(e.data); "
      "}})</script>"
      "<iframe src=page.html></iframe>",
      width, height);
  const std::string dom =
      output_of(fmt::format("chromium --headless --no-sandbox --disable-gpu --user-data-dir='{0}/profile' "
                            "--virtual-time-budget=20000 "
                            "--window-size=1500,900 --dump-dom 'file://{0}/frame.html' 2>/dev/null",
                            folder().string()));
  const std::size_t from = dom.find("<pre id=\"report\">");
  ASSERT_NE(from, std::string::npos) << dom.substr(0, 2000);
  const std::size_t start = from + std::string("<pre id=\"report\">").size();
  const std::string text = dom.substr(start, dom.find("</pre>", start) - start);
  ASSERT_FALSE(text.empty()) << "the page sent no report";
  const nlohmann::json report = nlohmann::json::parse(text);
  EXPECT_EQ(report.at("problem"), "");
  EXPECT_LE(report.at("width").get<int>(), width) << "the page scrolls sideways";
  EXPECT_EQ(report.at("viewers"), 2);
  EXPECT_EQ(report.at("broken"), 0);
  EXPECT_GE(report.at("narrowest").get<int>(), std::min(width - 70, 500));
  EXPECT_EQ(report.at("first"), "failed balls/ball moves");
  EXPECT_EQ(report.at("split"), "52") << "an arrow key moves the divider";
  EXPECT_EQ(report.at("unnamed"), 0);
  EXPECT_EQ(report.at("unreachable"), 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, PageAtWidth, testing::Values(std::array{1366, 768}, std::array{390, 844}),
                         [](const auto& info) { return info.param[0] > 1000 ? "laptop" : "phone"; });

}  // namespace
}  // namespace becalm::app
