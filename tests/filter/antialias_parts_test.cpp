// What temporal antialiasing is made of: where samples lie, vectors turned around, settings.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "filter/antialias/antialias_settings.h"
#include "filter/antialias/sample_grid.h"
#include "filter/input/motion_to_next.h"
#include "frame/error.h"

namespace becalm::filter {
namespace {

TEST(SampleGridTest, PutsTheSampleNearestToTheCentreIntoThePixel) {
  FrameJitter jitter{.positions_px = {{0.8f, -0.3f}}};
  const SampleGrid grid = sample_grid(jitter);
  EXPECT_EQ(grid.shift, Imath::V2i(-1, 0));
  EXPECT_EQ(grid.weights[9], 1.0f);
  // The pixel's own sample lies at (-0.2, -0.3); that of the pixel to the right at (0.8, -0.3).
  EXPECT_GT(grid.weights[4], grid.weights[5]);
  EXPECT_GT(grid.weights[5], grid.weights[3]) << "at (-1.2, -0.3)";
  EXPECT_EQ(sample_grid(std::nullopt).weights[9], 0.0f);
  jitter.positions_px.push_back({0.0f, 0.0f});
  EXPECT_EQ(sample_grid(jitter).weights[9], 0.0f) << "two samples have no one place";
}

TEST(MotionToNextTest, TurnsVectorsAroundAndKeepsTheClosest) {
  Frame next(2, 8, 1);
  Image& motion = next.add(Aov::motion);
  next.add(Aov::depth, 5.0f);
  motion.at(3, 0, 0) = 2.0f;  // lands on pixel 5, in front of what stands there
  next.image(Aov::depth).at(3, 0, 0) = 1.0f;
  const Image result = motion_to_next(next);
  EXPECT_EQ(result.at(5, 0, 0), -2.0f);
  EXPECT_EQ(result.at(4, 0, 0), 0.0f);
  EXPECT_TRUE(std::isnan(result.at(3, 0, 0))) << "what was there is hidden";
}

TEST(MotionToNextTest, CountsFromWhereTheSampleLies) {
  Frame next(2, 3, 3);
  next.set_jitter(FrameJitter{.positions_px = {{0.4f, -0.4f}}});
  Image& motion = next.add(Aov::motion, std::numeric_limits<float>::quiet_NaN());
  motion.at(1, 1, 0) = 0.3f;  // from 0.4 px to the right of the centre: into the next pixel
  motion.at(1, 1, 1) = -0.3f;
  const Image result = motion_to_next(next);
  EXPECT_EQ(result.at(2, 0, 0), -0.3f);
  EXPECT_EQ(result.at(2, 0, 1), 0.3f);
  EXPECT_TRUE(std::isnan(result.at(1, 1, 0)));
}

TEST(SparseGridTest, WeightsOfAPixelSumToOneOnAverage) {
  constexpr int positions = 64;
  constexpr int side = 4;
  for (const FilterShape filter : {FilterShape::blackman_harris, FilterShape::box, FilterShape::tent}) {
    for (const float radius_px : {0.5f, 1.0f, 1.5f}) {
      double sum = 0.0;
      for (int i = 0; i < positions; ++i) {
        const float at = (static_cast<float>(i) + 0.5f) / positions - 0.5f;
        const SparseGrid grid =
            sparse_grid(FrameJitter{.positions_px = {{at, 0.0f}}, .filter = filter, .radius_px = radius_px},
                        {}, {{0, 0}, {side - 1, side - 1}}, /*is_checkerboard=*/false);
        for (int x = 0; x < side; ++x) {
          for (int k = 1; k <= 3; ++k) sum += grid.columns.at(static_cast<std::size_t>(4 * x + k));
        }
      }
      EXPECT_NEAR(sum / (positions * side), 1.0, 0.01) << static_cast<int>(filter) << ' ' << radius_px;
    }
  }
}

TEST(AntialiasSettingsTest, AreToldByKeyAndRange) {
  AntialiasSettings settings = antialias_preset("best");
  set(settings, "refine_levels=3");
  EXPECT_NE(to_string(settings).find("refine_levels=3"), std::string::npos);
  EXPECT_THROW(set(settings, "refine_levels=13"), Error);
  EXPECT_THROW(set(settings, "nothing=1"), Error);
  EXPECT_THROW(antialias_preset("final"), Error);
}

TEST(AntialiasSettingsTest, SomePresetVariesEachOfThemAndSomePresetHasEachValue) {
  std::map<std::string, std::set<std::string>> values;
  for (const std::string_view preset : kAntialiasPresets) {
    std::istringstream words(to_string(antialias_preset(preset)));
    for (std::string word; words >> word;) {
      const auto equals = word.find('=');
      values[word.substr(0, equals)].insert(word.substr(equals + 1));
    }
  }
  EXPECT_EQ(values.size(), antialias_settings_table().size());
  for (const SettingInfo& row : antialias_settings_table()) {
    const std::set<std::string>& of_presets = values.at(std::string(row.key));
    EXPECT_GT(of_presets.size(), 1u) << row.key;
    // The values of an enum are told as "a, b or c".
    std::istringstream words{std::string(row.type)};
    for (std::string word; words >> word && word != "integer";) {
      if (word.ends_with(',')) word.pop_back();
      EXPECT_TRUE(word == "or" || of_presets.contains(word)) << row.key << '=' << word;
    }
  }
}

}  // namespace
}  // namespace becalm::filter
