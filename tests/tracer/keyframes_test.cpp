#include "tracer/math/keyframes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tracer/scene/transform.h"

namespace becalm::tracer {
namespace {

using Curve1 = Curve<1>;

Curve1 curve(std::vector<Curve1::Key> keys, Interpolation interpolation) {
  return Curve1(std::move(keys), interpolation);
}

TEST(Curve, HoldsOutsideTheKeysAndPassesThroughThem) {
  for (const Interpolation interpolation : {Interpolation::linear, Interpolation::smooth}) {
    const Curve1 c = curve({{1, {5}}, {3, {7}}, {10, {-2}}}, interpolation);
    EXPECT_EQ(c.at(-100)[0], 5);
    EXPECT_EQ(c.at(1)[0], 5);
    EXPECT_DOUBLE_EQ(c.at(3)[0], 7);
    EXPECT_EQ(c.at(10)[0], -2);
    EXPECT_EQ(c.at(11)[0], -2);
  }
}

TEST(Curve, LinearIsLinear) {
  const Curve1 c = curve({{0, {0}}, {4, {8}}}, Interpolation::linear);
  EXPECT_DOUBLE_EQ(c.at(1)[0], 2);
  EXPECT_DOUBLE_EQ(c.at(3.5)[0], 7);
}

TEST(Curve, SmoothWithTwoKeysEasesInAndOut) {
  const Curve1 c = curve({{0, {0}}, {1, {1}}}, Interpolation::smooth);
  for (const double t : {0.1, 0.25, 0.5, 0.9}) EXPECT_NEAR(c.at(t)[0], t * t * (3 - 2 * t), 1e-14);
}

TEST(Curve, SmoothNeverLeavesTheRangeOfTheKeysAroundIt) {
  const std::vector<Curve1::Key> keys = {{0, {0}},    {1, {0.1}}, {2, {10}}, {2.5, {10.2}},
                                         {7, {10.2}}, {8, {-3}},  {9, {5}}};
  const Curve1 c = curve(keys, Interpolation::smooth);
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    const double low = std::min(keys[i].value[0], keys[i + 1].value[0]);
    const double high = std::max(keys[i].value[0], keys[i + 1].value[0]);
    double before = keys[i].value[0];
    for (int step = 0; step <= 100; ++step) {
      const double value = c.at(keys[i].frame + (keys[i + 1].frame - keys[i].frame) * step / 100.0)[0];
      EXPECT_GE(value, low - 1e-12);
      EXPECT_LE(value, high + 1e-12);
      // Monotone: every step goes the way from key to key.
      EXPECT_GE((value - before) * (keys[i + 1].value[0] - keys[i].value[0]), -1e-12);
      before = value;
    }
  }
}

TEST(Curve, SmoothHasNoKinks) {
  const Curve1 c = curve({{0, {0}}, {3, {1}}, {4, {4}}, {9, {5}}}, Interpolation::smooth);
  const double h = 1e-6;
  for (const double frame : {0.0, 3.0, 4.0, 9.0}) {
    const double slope_before = (c.at(frame)[0] - c.at(frame - h)[0]) / h;
    const double slope_after = (c.at(frame + h)[0] - c.at(frame)[0]) / h;
    EXPECT_NEAR(slope_before, slope_after, 1e-4) << frame;
  }
  EXPECT_GT((c.at(3 + h)[0] - c.at(3)[0]) / h, 0.3) << "inner keys are passed at speed";
}

TEST(Curve, KnowsWhetherItChanges) {
  EXPECT_FALSE(Curve1(Curve1::Value{3}).animated());
  EXPECT_FALSE(curve({{0, {3}}, {1, {3}}}, Interpolation::linear).animated());
  EXPECT_TRUE(curve({{0, {3}}, {1, {4}}}, Interpolation::linear).animated());
}

TEST(Transform, ScalesThenTurnsThenMoves) {
  // (1,0,0) -> scaled (2,0,0) -> turned 90 degrees about z: (0,2,0) -> moved (10,22,30).
  const TransformCurve c = TransformCurve::Value{10, 20, 30, 0, 0, 90, 2, 3, 4};
  const V3d p = transform_point(V3d(1, 0, 0), transform_at(c, 0));
  EXPECT_NEAR((p - V3d(10, 22, 30)).length(), 0.0, 1e-12);
}

TEST(Transform, TurnsAboutXFirst) {
  // Right-handed: x by 90 takes y to z, then y by 90 takes z to x.
  const TransformCurve c = TransformCurve::Value{0, 0, 0, 90, 90, 0, 1, 1, 1};
  const V3d p = transform_point(V3d(0, 1, 0), transform_at(c, 0));
  EXPECT_NEAR((p - V3d(1, 0, 0)).length(), 0.0, 1e-12);
}

TEST(Transform, FullTurnsAreTurned) {
  const TransformCurve c({{0, {0, 0, 0, 0, 0, 0, 1, 1, 1}}, {4, {0, 0, 0, 0, 360, 0, 1, 1, 1}}},
                         Interpolation::linear);
  const V3d p = transform_point(V3d(1, 0, 0), transform_at(c, 1));
  EXPECT_NEAR((p - V3d(0, 0, -1)).length(), 0.0, 1e-12);
}

}  // namespace
}  // namespace becalm::tracer
