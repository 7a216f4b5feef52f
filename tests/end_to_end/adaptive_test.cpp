// Samples where the filter needs them, and presets and samples by the time that there is.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

class Adaptive : public testing::Test {
 protected:
  Outcome render(const std::string& pattern, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / pattern};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return becalm_done(arguments);
  }
  std::string settings_of(const std::string& file) const {
    return io::read_attribute(folder_ / file, "becalm:settings");
  }

  TempFolder folder_;
  std::string scene_ = write_scene(folder_);
};

/// The numbers in front of ` samples per pixel` in what --verbose prints.
std::vector<double> samples_told(const std::string& text) {
  constexpr std::string_view words = " samples per pixel\n";
  std::vector<double> found;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) {
    found.push_back(std::stod(text.substr(text.rfind(' ', at - 1) + 1)));
  }
  return found;
}

TEST_F(Adaptive, SamplesAreSharedOutAroundTheirMean) {
  const std::vector<std::string> options{"--frames",        "2-3",        "--spp", "8",
                                         "--denoise=draft", "--adaptive", "-v"};
  std::vector<std::string> kept = options;
  kept.insert(kept.end(), {"--keep-noisy", folder_ / "n.####.exr"});
  const Outcome outcome = render("a.####.exr", kept);
  const std::vector<double> samples = samples_told(outcome.err);
  ASSERT_EQ(samples.size(), 2u) << outcome.err;
  for (const double mean : samples) EXPECT_NEAR(mean, 8.0, 0.8);
  EXPECT_NE(settings_of("a.0002.exr").find("spp=8 adaptive=yes"), std::string::npos);

  render("b.####.exr", options);
  expect_same_beauty(folder_ / "a.####.exr", folder_ / "b.####.exr", 2, 3);
  render("u.####.exr", {"--frames", "2-3", "--spp", "8", "--denoise=draft"});
  EXPECT_FALSE(same_pixels(read_frame(folder_ / "a.0002.exr").image(Aov::beauty),
                           read_frame(folder_ / "u.0002.exr").image(Aov::beauty)));
  expect_error(becalm({"render", scene_, "-o", folder_ / "a.####.exr", "--frames", "2-3", "--spp", "8",
                       "--denoise=draft", "--resume"}),
               2, {"--resume", "adaptive"});
}

TEST_F(Adaptive, NoisyFramesDoNotDependOnOtherFramesOrThreads) {
  const auto noisy = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> options{"--spp", "4", "--denoise=draft", "--adaptive", "--context", "none"};
    options.insert(options.end(), {"--keep-noisy", folder_ / (name + ".n.####.exr")});
    options.insert(options.end(), more.begin(), more.end());
    render(name + ".####.exr", options);
    return folder_ / (name + ".n.####.exr");
  };
  const std::string whole = noisy("whole", {"--frames", "1-4"});
  const std::string part = noisy("part", {"--frames", "3", "--threads", "1"});
  expect_same_beauty(whole, part, 3, 3);
}

TEST_F(Adaptive, SamplesDoNotDecideOverTheirOwnNumber) {
  // A frame and its pilot of one pixel and two samples each, of which in half of the frames one is bright.
  // Were they the same samples, bright ones would be outvoted and the mean would fall.
  constexpr int kFrames = 24;
  write_text(scene_, R"({"frames": {"first": 1, "last": 24}, "integrator": {"max_depth": 0},
    "film": {"width": 1, "height": 1, "filter": {"type": "box", "radius_px": 0.5}},
    "camera": {"fov_y_deg": 90, "look_at": {"eye": [0, 0, 1], "target": [0, 0, 0]}},
    "materials": {"black": {"type": "diffuse", "reflectance": 0}}, "meshes": {"plane": {"shape": "rectangle"}},
    "objects": [{"name": "a quarter of the pixel", "mesh": "plane", "material": "black", "emission": 1,
      "transform": {"rotate_deg": [90, 0, 0], "scale": 0.5, "translate": [-0.5, 0.5, 0]}}]})");
  const std::vector<double> samples =
      samples_told(render("a.####.exr", {"--denoise=draft", "--noise-target", "0.0005", "--spp", "4096",
                                         "--context", "none", "-v"})
                       .err);
  ASSERT_EQ(samples.size(), kFrames);
  render("two.####.exr", {"--spp", "2", "--quiet"});
  int more = 0, bright = 0, both = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    const bool is_bright =
        read_frame(frame_path(folder_ / "two.####.exr", frame)).image(Aov::beauty).at(0, 0, 0) > 0.0f;
    const bool has_more = samples[static_cast<std::size_t>(frame - 1)] > 2.0;
    more += has_more;
    bright += is_bright;
    both += is_bright && has_more;
  }
  for (const int count : {more, bright}) EXPECT_NEAR(count, kFrames / 2, kFrames / 4);
  EXPECT_NEAR(both, kFrames / 4, kFrames / 6);
}

TEST_F(Adaptive, ATargetTakesAsManySamplesAsItNeeds) {
  double before = 0.0;
  for (const char* target : {"0.1", "0.01"}) {
    const Outcome outcome =
        render("a.exr", {"--frames", "2", "--denoise=draft", "--noise-target", target, "-v", "--spp", "64"});
    const std::vector<double> samples = samples_told(outcome.err);
    ASSERT_EQ(samples.size(), 1u) << outcome.err;
    EXPECT_GT(samples[0], before);
    EXPECT_LE(samples[0], 64.0);
    before = samples[0];
    EXPECT_NE(outcome.err.find("noise expected in the frames: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(fmt::format("of {:.3g} samples per pixel on average", samples[0])),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.err.find("% of the pixels have the most that --spp allows") != std::string::npos,
              target == std::string_view("0.01"))
        << outcome.err;
  }
  EXPECT_NE(settings_of("a.exr").find("spp=64 noise_target=0.01"), std::string::npos) << settings_of("a.exr");
}

TEST_F(Adaptive, RadianceMayBeOfAnySize) {
  std::ifstream file(scene_);
  const std::string usual{std::istreambuf_iterator<char>(file), {}};
  const auto lit_by = [&](int exponent) {
    std::string text = usual;
    const auto replace = [&](std::string_view before, const std::string& after) {
      text.replace(text.find(before), before.size(), after);
    };
    replace("[8, 8, 7]", fmt::format("[8e{0}, 8e{0}, 7e{0}]", exponent));
    replace("[0.1, 0.1, 0.2]", fmt::format("[1e{0}, 1e{0}, 2e{0}]", exponent - 1));
    write_text(scene_, text);
    const Outcome outcome = render("a.exr", {"--frames", "2", "--denoise=draft", "--noise-target", "0.08",
                                             "-v", "--spp", "64", "--float"});
    constexpr std::string_view words = "noise expected in the frames: ";
    const double noise = std::stod(outcome.err.substr(outcome.err.find(words) + words.size()));
    return std::pair(samples_told(outcome.err).at(0), noise);
  };
  const auto [samples, noise] = lit_by(0);
  for (const int exponent : {-25, 25}) {
    const auto [found_samples, found_noise] = lit_by(exponent);
    EXPECT_NEAR(found_samples, samples, 0.1 * samples) << exponent;
    EXPECT_NEAR(found_noise, noise, 0.1 * noise) << exponent;
  }
}

TEST_F(Adaptive, ATimeBudgetDecidesOnceForAllFrames) {
  const Outcome outcome =
      render("a.####.exr", {"--frames", "1", "--denoise", "--time-budget", "200ms", "--context", "1-4"});
  EXPECT_NE(outcome.err.find(" per pixel on average and "), std::string::npos) << outcome.err;
  const std::string settings = settings_of("a.0001.exr");
  const Outcome more = render("a.####.exr", {"--frames", "1-2", "--denoise", "--time-budget", "100ms",
                                             "--context", "1-4", "--resume"});
  EXPECT_NE(more.err.find("as in the frames that are there"), std::string::npos) << more.err;
  EXPECT_EQ(settings_of("a.0001.exr"), settings);
  EXPECT_EQ(settings_of("a.0002.exr"), settings);
}

TEST_F(Adaptive, ABudgetThatNothingFitsTakesTheLeast) {
  const Outcome outcome =
      render("a.exr", {"--frames", "1", "--denoise", "--time-budget", "0.01ms", "--context", "none"});
  EXPECT_NE(outcome.err.find("1 sample per pixel on average and draft"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("no preset takes less"), std::string::npos) << outcome.err;
}

TEST_F(Adaptive, DenoiseTakesThePresetThatTheTimeAllows) {
  render("n.####.exr", {"--frames", "1-2", "--spp", "1", "--aovs", "albedo,normal"});
  const auto denoise = [&](const char* time, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{
        "denoise", folder_ / "n.####.exr", "-o", folder_ / "d.####.exr", "--time", time};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return becalm_done(arguments).err;
  };
  const auto preset = [&] { return io::read_attribute(folder_ / "d.0001.exr", "becalm:preset"); };
  EXPECT_NE(denoise("1h").find("final: about "), std::string::npos);
  EXPECT_EQ(preset(), "final");
  EXPECT_NE(denoise("0.001ms").find("no preset takes less"), std::string::npos);
  EXPECT_EQ(preset(), "draft");
  fs::remove(folder_ / "d.0002.exr");
  write_text(folder_ / "n.0003.exr", "half a frame");
  const std::string told = denoise("1h", {"--resume", "--missing", "skip"});
  EXPECT_NE(told.find("draft, as in the frames that are there"), std::string::npos) << told;
  const std::size_t damaged = told.find("frame 3 is damaged");
  EXPECT_NE(damaged, std::string::npos) << told;
  EXPECT_EQ(damaged, told.rfind("frame 3 is damaged")) << "told once";
}

TEST_F(Adaptive, OptionsThatDoNotFitAreRefused) {
  const auto refused = [&](std::vector<std::string> more, const std::vector<std::string>& words) {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / "x.####.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_error(becalm(arguments), 2, words);
  };
  refused({"--adaptive"}, {"--adaptive", "--denoise"});
  refused({"--noise-target", "0.1"}, {"--noise-target", "--denoise"});
  refused({"--time-budget", "1s"}, {"--time-budget", "--denoise"});
  refused({"--denoise", "--noise-target", "0"}, {"--noise-target", "0"});
  refused({"--denoise", "--time-budget", "soon"}, {"--time-budget soon", "2s"});
  refused({"--denoise", "--time-budget", "1s", "--spp", "4"}, {"--time-budget", "--spp"});
  refused({"--denoise", "--time-budget", "1s", "--noise-target", "0.1"}, {"--time-budget", "--noise-target"});
  refused({"--denoise", "--adaptive", "--noise-target", "0.1"}, {"--noise-target", "--adaptive"});
  refused({"--denoise=paper", "--time-budget", "1s"}, {"--time-budget", "draft, balanced or final"});
  expect_error(
      becalm({"denoise", folder_ / "n.exr", "-o", folder_ / "d.exr", "--time", "1s", "--preset", "draft"}), 2,
      {"--time", "--preset"});
}

}  // namespace
}  // namespace becalm::test
