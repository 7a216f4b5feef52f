#include "filter/settings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "frame/error.h"
#include "tests/error_of.h"

namespace becalm::filter {
namespace {

std::string error_of(const std::string& assignment) {
  Settings settings;
  const std::string error = becalm::error_of(ExitStatus::usage, [&] { set(settings, assignment); });
  EXPECT_EQ(to_string(settings), to_string(Settings())) << "a refused value left a trace";
  return error;
}

TEST(Settings, EveryKeyCanBeSetToWhatItPrints) {
  for (const char* name : {"final", "paper"}) {
    const std::string text = to_string(preset(name));
    Settings settings;
    std::istringstream words(text);
    for (std::string word; words >> word;) set(settings, word);
    EXPECT_EQ(to_string(settings), text);
  }
}

TEST(Settings, EveryRowHasHelpAndAppearsInTheText) {
  const std::string text = to_string(Settings());
  for (const SettingInfo& row : settings_table()) {
    EXPECT_FALSE(row.help.empty()) << row.key;
    EXPECT_FALSE(row.type.empty()) << row.key;
    EXPECT_NE((" " + text).find(" " + std::string(row.key) + "="), std::string::npos) << row.key;
  }
}

TEST(Settings, SomePresetVariesEachOfThemButThePapersDistances) {
  std::map<std::string, std::set<std::string>> values;
  for (const char* name : {"draft", "balanced", "final", "paper"}) {
    std::istringstream words(to_string(preset(name)));
    for (std::string word; words >> word;) {
      const auto equals = word.find('=');
      values[word.substr(0, equals)].insert(word.substr(equals + 1));
    }
  }
  EXPECT_EQ(values.size(), settings_table().size());
  EXPECT_EQ(values.at("distance").size(), 1u);
  values.erase("distance");
  for (const auto& [key, of_presets] : values) EXPECT_GT(of_presets.size(), 1u) << key;
}

TEST(Settings, ValuesArrive) {
  Settings settings;
  set(settings, "blur_radius=10,4,2");
  set(settings, "distance=l1");
  set(settings, "motion=override");
  set(settings, "merge=mask");
  set(settings, "pyramid=4x3");
  set(settings, "resample=bilinear");
  set(settings, "guides=0");
  set(settings, "smooth_albedo=no");
  EXPECT_EQ(settings.blur_radius, (std::vector{10, 4, 2}));
  EXPECT_EQ(settings.distance, Distance::l1);
  EXPECT_EQ(settings.motion, MotionUse::override_offset);
  EXPECT_EQ(settings.merge, MergeMode::mask);
  EXPECT_EQ(settings.pyramid.factor, 4);
  EXPECT_EQ(settings.pyramid.levels, 3);
  EXPECT_EQ(settings.resample, Resample::bilinear);
  EXPECT_FALSE(settings.guides);
  EXPECT_FALSE(settings.smooth_albedo);
  set(settings, "guides=yes");
  EXPECT_TRUE(settings.guides);
  set(settings, "pyramid=2");
  EXPECT_EQ(settings.pyramid.factor, 2);
  EXPECT_EQ(settings.pyramid.levels, 0);
}

TEST(Settings, BadAssignmentsNameKeyValueAndRange) {
  EXPECT_EQ(error_of("patch_radius=9"), "--set patch_radius: value '9': expected integer 1..8");
  EXPECT_EQ(error_of("match_downsample=3"), "--set match_downsample: value '3': expected 1, 2 or 4");
  EXPECT_EQ(error_of("merge=mask:0.9,2,2"), "--set merge: value 'mask:0.9,2,2': expected variance or mask");
  for (const char* value : {"3", "4x", "x4", "4x0", "2x13", "2x3x4"}) {
    EXPECT_EQ(
        error_of(fmt::format("pyramid={}", value)),
        fmt::format("--set pyramid: value '{}': expected FACTOR or FACTORxLEVELS, such as 2 or 4x4", value));
  }
  EXPECT_EQ(error_of("blur_radius=2,,3"),
            "--set blur_radius: value '2,,3': expected integers 0..10 joined by commas");
  EXPECT_EQ(error_of("distance=L1"),
            "--set distance: value 'L1': expected l2, l1, log_l1 or log_l1_centered");
  EXPECT_EQ(error_of("guides=2"), "--set guides: value '2': expected 0 or 1");
  EXPECT_EQ(error_of("motion=Guide"), "--set motion: value 'Guide': expected none, guide or override");
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
