#include "frame/judge/exact.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace becalm::judge {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// 3x2 pixels of 3 channels, each of another value.
Image picture() {
  Image image(3, 2, 3);
  for (std::size_t i = 0; i < image.data().size(); ++i)
    image.data()[i] = 0.125f * static_cast<float>(i) - 1.0f;
  return image;
}

ExactResult compare_values(float test, float reference, Stored stored = Stored::float32) {
  return compare_exactly(Image(1, 1, 1, test), Image(1, 1, 1, reference), stored);
}

TEST(Exact, EqualImagesPass) {
  const ExactResult result = compare_exactly(picture(), picture());
  EXPECT_TRUE(result.passed());
  EXPECT_FALSE(result.first.has_value());
  EXPECT_EQ(describe(result), "all pixels are equal, bit for bit");
}

TEST(Exact, CountsPixelsAndNamesTheFirstAndTheLargestDifference) {
  const Image reference = picture();
  Image test = reference;
  test.at(1, 0, 2) = std::nextafter(reference.at(1, 0, 2), kInf);
  test.at(2, 1, 0) = 5.0f;
  test.at(2, 1, 1) = -6.0f;  // of a pixel that is counted already
  const ExactResult result = compare_exactly(test, reference);
  EXPECT_EQ(result.differing_pixels, 2u);
  ASSERT_TRUE(result.first && result.largest);
  EXPECT_EQ(result.first->x, 1);
  EXPECT_EQ(result.first->y, 0);
  EXPECT_EQ(result.first->channel, 2);
  EXPECT_EQ(result.first->ulps, 1u);
  EXPECT_EQ(result.largest->x, 2);
  EXPECT_EQ(result.largest->channel, 1);
  EXPECT_EQ(result.largest->test, -6.0f);
  const std::string text = describe(result);
  EXPECT_NE(text.find("2 pixels differ; first pixel 1,0 channel 2"), std::string::npos) << text;
  EXPECT_NE(text.find("largest pixel 2,1 channel 1: -6 instead of"), std::string::npos) << text;
}

TEST(Exact, CountsUlpsAcrossZeroAndToInfinity) {
  const float smallest = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(compare_values(smallest, -smallest).first->ulps, 2u);
  EXPECT_EQ(compare_values(std::numeric_limits<float>::max(), kInf).first->ulps, 1u);
  EXPECT_EQ(compare_values(-kInf, kInf).first->ulps, 2u * 0x7f800000u);
}

TEST(Exact, CountsUlpsOfWhatIsStored) {
  EXPECT_EQ(compare_values(1.0f + 0x1p-10f, 1.0f).first->ulps, 1u << 13);
  EXPECT_EQ(compare_values(1.0f + 0x1p-10f, 1.0f, Stored::half).first->ulps, 1u);
  EXPECT_EQ(compare_values(-0x1p-24f, 0x1p-24f, Stored::half).first->ulps, 2u);
}

TEST(Exact, TheLargestDifferenceIsThatOfMostUlpsOfWhatIsStored) {
  const Image reference(2, 1, 1, 0.0f);
  Image test = reference;
  test.at(0, 0, 0) = 0x1p-24f;  // half's neighbour of 0, and far from it among floats
  test.at(1, 0, 0) = 0x1p-20f;
  EXPECT_EQ(compare_exactly(test, reference, Stored::half).largest->x, 1);
  Image other = reference;
  Image near = reference;
  other.at(1, 0, 0) = 1.0f;
  near.at(0, 0, 0) = 0x1p-24f;
  near.at(1, 0, 0) = 1.5f;
  EXPECT_EQ(compare_exactly(near, other, Stored::half).largest->ulps, 512u);
  EXPECT_EQ(compare_exactly(near, other, Stored::float32).largest->x, 0);
}

TEST(Exact, ZerosOfBothSignsDiffer) {
  const ExactResult result = compare_values(-0.0f, 0.0f);
  EXPECT_FALSE(result.passed());
  EXPECT_EQ(result.first->ulps, 0u);
}

TEST(Exact, AnyNanEqualsAnyOtherAndNoNumber) {
  EXPECT_TRUE(compare_values(kNan, std::bit_cast<float>(0xffc12345u)).passed());
  const ExactResult result = compare_values(kNan, 1.0f);
  EXPECT_FALSE(result.passed());
  EXPECT_FALSE(result.first->ulps.has_value());
  EXPECT_FALSE(compare_values(1.0f, kNan).passed());
}

TEST(Exact, RefusesOtherShapes) {
  EXPECT_THROW(compare_exactly(Image(2, 1, 3), Image(1, 2, 3)), std::invalid_argument);
  EXPECT_THROW(compare_exactly(Image(2, 1, 3), Image(2, 1, 4)), std::invalid_argument);
}

}  // namespace
}  // namespace becalm::judge
