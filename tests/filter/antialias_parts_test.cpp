// What temporal antialiasing is made of: where samples lie, vectors turned around, settings.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

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

TEST(AntialiasSettingsTest, AreToldByKeyAndRange) {
  AntialiasSettings settings = antialias_preset("best");
  set(settings, "gamma=0.75");
  EXPECT_NE(to_string(settings).find("gamma=0.75"), std::string::npos);
  EXPECT_THROW(set(settings, "gamma=100"), Error);
  EXPECT_THROW(set(settings, "nothing=1"), Error);
  EXPECT_THROW(antialias_preset("final"), Error);
}

}  // namespace
}  // namespace becalm::filter
