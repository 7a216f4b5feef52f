// becalm compare: which layer and which view of a file is measured.

#include <gtest/gtest.h>

#include "frame/io/exr.h"
#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

class CompareLayers : public testing::Test {
 protected:
  /// What Blender rendered and what it denoised: shares of one picture.
  void write_blender(const std::string& name, float noisy, float combined) const {
    write_shares(folder_ / name, noise_frame(1), {{"V.Combined.", combined}, {"V.Noisy Image.", noisy}});
  }
  Outcome compared(const std::string& reference, const std::string& test,
                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"compare", folder_ / reference, folder_ / test, "--max-relmse", "1e-6"};
    words.insert(words.end(), more.begin(), more.end());
    return becalm(words);
  }

  TempFolder folder_;
};

TEST_F(CompareLayers, WhatBlenderRenderedIsMeasuredNotWhatItDenoised) {
  write_blender("noisy.exr", 1.0f, 0.5f);
  write_blender("denoised.exr", 0.8f, 0.5f);
  write_shares(folder_ / "plain.exr", noise_frame(1), {{"", 0.8f}});
  const Outcome outcome = compared("noisy.exr", "denoised.exr");
  EXPECT_EQ(outcome.status, 1) << "the layers that both passed on are equal";
  EXPECT_NE(outcome.err.find("denoised.exr: V.Combined is denoised already: measured is V.Noisy Image"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(compared("plain.exr", "denoised.exr").status, 0) << "each file has its own layers";
  EXPECT_EQ(compared("noisy.exr", "denoised.exr", {"--layers", "beauty=V.Combined"}).status, 0);
}

TEST_F(CompareLayers, WhatBecalmDenoisedIsMeasuredWhicheverLayerItTook) {
  write_blender("in.0001.exr", 1.0f, 1.0f);  // as Blender 2.92 writes it for denoisers
  becalm_done({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "equal.exr"});
  write_blender("in.0001.exr", 1.0f, 0.9f);
  becalm_done(
      {"denoise", folder_ / "in.0001.exr", "-o", folder_ / "told.exr", "--layers", "beauty=V.Combined"});
  becalm_done({"denoise", folder_ / "in.0001.exr", "-o", folder_ / "noisy.exr"});
  for (const auto& [name, layer] :
       {std::pair{"equal.exr", "V.Combined"}, {"told.exr", "V.Combined"}, {"noisy.exr", "V.Noisy Image"}}) {
    const io::LoadedFrame denoised = io::read_exr(folder_ / name, 1, {}, {.layers = {{Aov::beauty, layer}}});
    io::write_exr(folder_ / "plain.exr", denoised.frame, {}, io::PixelType::float32);
    const Outcome outcome = compared("plain.exr", name);
    EXPECT_EQ(outcome.status, 0) << name << ": " << outcome.err;
  }
}

TEST_F(CompareLayers, TheViewIsThatOfTheReference) {
  const Frame left = noise_frame(1);
  const Frame right = noise_frame(2);
  const auto write = [&](const std::string& name, const std::vector<io::WrittenView>& views) {
    io::write_exr(folder_ / name, views, {});
  };
  write("both.exr", {{"left", &left}, {"right", &right}});
  write("turned.exr", {{"right", &right}, {"left", &left}});
  write("left.exr", {{"left", &left}});
  write("right.exr", {{"right", &right}});
  write("main.exr", {{"main", &right}});
  EXPECT_EQ(compared("right.exr", "both.exr").status, 0);
  EXPECT_EQ(compared("left.exr", "both.exr").status, 0);
  EXPECT_EQ(compared("both.exr", "turned.exr").status, 0);
  EXPECT_EQ(compared("turned.exr", "both.exr").status, 0);
  EXPECT_EQ(compared("right.exr", "main.exr").status, 0) << "the only view there is";
  write("r.exr", {{"R", &right}});
  EXPECT_EQ(compared("r.exr", "both.exr").status, 0) << "the same eye";
  const Outcome first = compared("main.exr", "turned.exr");
  EXPECT_EQ(first.status, 0) << "no eye, so the first view";
  EXPECT_NE(first.err.find("measured is the view right of right, left"), std::string::npos) << first.err;
  expect_error(compared("right.exr", "left.exr"), kBadInput,
               {"left.exr: no view 'right', which the reference is of; expected left"});
  expect_error(compared("right.exr", "both.exr", {"--view", "left"}), kBadInput,
               {"right.exr: no view 'left'"});
}

}  // namespace
}  // namespace becalm::test
