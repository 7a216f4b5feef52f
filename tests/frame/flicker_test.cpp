#include "frame/flicker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace becalm {
namespace {

Image constant(float value) {
  return Image(4, 3, 3, value);
}

void add(Flicker& flicker, const Image& test, const Image& reference) {
  flicker.add(test, reference, reference);
}

TEST(Flicker, AnErrorThatStandsStillDoesNotCount) {
  Flicker flicker;
  for (const float value : {0.5f, 1.0f, 2.0f}) add(flicker, constant(value + 0.25f), constant(value));
  EXPECT_NEAR(flicker.measured().value, 0.0, 1e-12);
}

TEST(Flicker, IsTheVarianceOfTheErrorOverTime) {
  Flicker flicker;
  for (const float error : {-0.25f, 0.25f, 0.0f}) add(flicker, constant(1.0f + error), constant(1.0f));
  EXPECT_NEAR(flicker.measured().value, 0.0625 / 1.01, 1e-12);
}

TEST(Flicker, NoiseOfTwoReferencesIsNoFlicker) {
  Flicker one;
  Flicker two;
  for (int frame = 0; frame < 4; ++frame) {
    const float a = frame % 2 == 0 ? 0.75f : 1.25f;
    const float b = frame < 2 ? 0.75f : 1.25f;  // uncorrelated with a
    add(one, constant(1.0f), constant(a));
    two.add(constant(1.0f), constant(a), constant(b));
  }
  EXPECT_GT(one.measured().value, 0.05);
  EXPECT_NEAR(two.measured().value, 0.0, 1e-12);
}

TEST(Flicker, SkipsPixelsThatAreNotFiniteInAFrame) {
  Flicker flicker;
  for (const float error : {-0.25f, 0.25f}) {
    Image test = constant(1.0f + error);
    if (error > 0.0f) test.at(1, 1, 2) = std::numeric_limits<float>::quiet_NaN();
    add(flicker, test, constant(1.0f));
  }
  EXPECT_EQ(flicker.measured().skipped, 1u);
  EXPECT_NEAR(flicker.measured().value, 0.125 / 1.01, 1e-12);
}

TEST(Flicker, NeedsTwoFramesOfOneSize) {
  Flicker flicker;
  EXPECT_TRUE(std::isnan(flicker.measured().value));
  add(flicker, constant(1.0f), constant(1.0f));
  EXPECT_TRUE(std::isnan(flicker.measured().value));
  const Image other(5, 3, 3);
  EXPECT_THROW(add(flicker, other, other), std::invalid_argument);
}

}  // namespace
}  // namespace becalm
