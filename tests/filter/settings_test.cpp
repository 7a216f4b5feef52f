#include "filter/settings.h"

#include <gtest/gtest.h>

#include "frame/error.h"

namespace becalm::filter {
namespace {

std::string error_of(const std::string& assignment) {
  Settings settings;
  try {
    set(settings, assignment);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::usage);
    EXPECT_EQ(to_string(settings), to_string(Settings())) << "a refused value left a trace";
    return error.what();
  }
  return "no error";
}

TEST(Settings, EveryKeyCanBeSetToWhatItPrints) {
  const std::string text = to_string(preset("final"));
  Settings settings;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    set(settings, text.substr(begin, end - begin));
    begin = end + 1;
  }
  EXPECT_EQ(to_string(settings), text);
}

TEST(Settings, EveryRowHasHelpAndAppearsInTheText) {
  const std::string text = to_string(Settings());
  for (const SettingInfo& row : settings_table()) {
    EXPECT_FALSE(row.help.empty()) << row.key;
    EXPECT_FALSE(row.type.empty()) << row.key;
    EXPECT_NE((" " + text).find(" " + std::string(row.key) + "="), std::string::npos) << row.key;
  }
}

TEST(Settings, ValuesArrive) {
  Settings settings;
  set(settings, "blur_radius=10,4,2");
  set(settings, "distance=l1");
  set(settings, "merge=mask");
  set(settings, "mask_alpha=0.25");
  set(settings, "resample=bilinear");
  EXPECT_EQ(settings.blur_radius, (std::vector{10, 4, 2}));
  EXPECT_EQ(settings.distance, Distance::l1);
  EXPECT_EQ(settings.merge, MergeMode::mask);
  EXPECT_EQ(settings.mask_alpha, 0.25f);
  EXPECT_EQ(settings.resample, Resample::bilinear);
}

TEST(Settings, BadAssignmentsNameKeyValueAndRange) {
  EXPECT_EQ(error_of("patch_radius=9"), "--set patch_radius: value '9': expected integer 1..8");
  EXPECT_EQ(error_of("match_downsample=3"), "--set match_downsample: value '3': expected 1, 2 or 4");
  EXPECT_EQ(error_of("mask_alpha=nan"), "--set mask_alpha: value 'nan': expected number 0..1");
  EXPECT_EQ(error_of("blur_radius=2,,3"),
            "--set blur_radius: value '2,,3': expected integers 0..10 joined by commas");
  EXPECT_EQ(error_of("distance=L1"),
            "--set distance: value 'L1': expected l2, l1, log_l1 or log_l1_centered");
  EXPECT_EQ(error_of("refine_levels=2x"), "--set refine_levels: value '2x': expected integer 0..12");
  EXPECT_EQ(error_of("patch_radius"), "--set 'patch_radius': expected KEY=VALUE");
  EXPECT_TRUE(error_of("radius=3").starts_with("--set: no setting 'radius'; there are match_downsample, "));
}

TEST(Settings, PresetsDifferAndOthersAreRefused) {
  EXPECT_EQ(preset("draft").match_downsample, 4);
  EXPECT_EQ(preset("balanced").match_downsample, 2);
  EXPECT_EQ(preset("final").match_downsample, 1);
  EXPECT_EQ(preset("paper").merge, MergeMode::mask);
  EXPECT_EQ(preset("paper").smooth, Smooth::none);
  EXPECT_THROW(preset("best"), Error);
}

}  // namespace
}  // namespace becalm::filter
