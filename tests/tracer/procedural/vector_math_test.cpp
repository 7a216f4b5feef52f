#include "tracer/procedural/vector_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace becalm::tracer {
namespace {

TEST(VectorMath, SinesAndCosinesOfTurns) {
  for (int k = -40000; k <= 40000; ++k) {
    const float turns = static_cast<float>(k) * 1.37e-4f;
    const SinCos computed = sin_cos_turns(turns);
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(turns);
    ASSERT_NEAR(computed.sin, std::sin(angle), 3e-7) << turns;
    ASSERT_NEAR(computed.cos, std::cos(angle), 3e-7) << turns;
  }
}

TEST(VectorMath, PowersOfTwo) {
  for (int k = -1250; k <= 1250; ++k) {
    const float x = static_cast<float>(k) * 0.1f;
    ASSERT_NEAR(exp2_fast(x) / std::exp2(static_cast<double>(x)), 1.0, 4e-7) << x;
  }
  EXPECT_EQ(exp2_fast(0.0f), 1.0f);
  EXPECT_LE(exp2_fast(-1e30f), 0x1p-125f);
  EXPECT_GT(exp2_fast(-1e30f), 0.0f);
}

}  // namespace
}  // namespace becalm::tracer
