#include <gtest/gtest.h>

#include "frame/error.h"
#include "frame/io/layers.h"
#include "tests/error_of.h"

namespace becalm::io {
namespace {

TEST(LayerOverrides, Parsed) {
  const LayerOverrides overrides = parse_layer_overrides("albedo=ViewLayer.Denoising Albedo,beauty=a.b");
  EXPECT_EQ(overrides, (LayerOverrides{{Aov::albedo, "ViewLayer.Denoising Albedo"}, {Aov::beauty, "a.b"}}));
  EXPECT_TRUE(parse_layer_overrides("").empty());
}

TEST(LayerOverrides, Errors) {
  EXPECT_NE(error_of(ExitStatus::usage, [] { parse_layer_overrides("colour=X"); })
                .find("no AOV is called 'colour'"),
            std::string::npos);
  EXPECT_EQ(error_of(ExitStatus::usage, [] { parse_layer_overrides("albedo="); }),
            "layers 'albedo=': no layer name; expected albedo=NAME");
  EXPECT_EQ(error_of(ExitStatus::usage, [] { parse_layer_overrides("albedo"); }),
            "layers 'albedo': no layer name; expected albedo=NAME");
}

TEST(LayerOverrides, TheBeautyCannotBeLeftOut) {
  EXPECT_EQ(error_of(ExitStatus::usage, [] { parse_layer_overrides("beauty=none"); }),
            "layers 'beauty=none': the beauty cannot be left out");
}

TEST(LayerOverrides, RgbaIsTheNameOfBareColours) {
  const std::vector<std::string> channels{"B", "Beauty_Noisy.B", "Beauty_Noisy.G", "Beauty_Noisy.R", "G",
                                          "R"};
  const auto beauty = [&](const std::string& name) {
    return find_layers("f", {{.channels = channels}}, {.layers = {{Aov::beauty, name}}})[0]->channels[0];
  };
  EXPECT_EQ(beauty("RGBA"), "R");
  EXPECT_EQ(beauty("beauty_noisy"), "Beauty_Noisy.R");
}

TEST(MotionChange, Parsed) {
  EXPECT_EQ(parse_motion_change(""), MotionChange());
  EXPECT_EQ(parse_motion_change("flip-y,swap,scale=-2"),
            (MotionChange{.swap = true, .scale = {-2.0f, 2.0f}}));
}

TEST(MotionChange, Errors) {
  EXPECT_EQ(error_of(ExitStatus::usage, [] { parse_motion_change("flip"); }),
            "motion 'flip': expected some of flip-x, flip-y, scale=S and swap");
  for (const std::string text : {"scale=", "scale=0", "scale=x", "scale=1x", "scale=inf", "scale=nan"}) {
    EXPECT_EQ(error_of(ExitStatus::usage, [&] { parse_motion_change(text); }),
              "motion '" + text + "': expected scale=S with a number other than 0");
  }
}

}  // namespace
}  // namespace becalm::io
