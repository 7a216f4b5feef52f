// Which pairs of triangles are sampled as one rectangle.
#include "tracer/lights/rectangles.h"

#include <gtest/gtest.h>

#include <vector>

namespace becalm::tracer {
namespace {

const V3f kA(-1, 1, -1), kB(1, 1, -1), kC(1, 1, 1), kD(-1, 1, 1);

EmissiveTriangle triangle(const V3f& a, const V3f& b, const V3f& c, float radiance = 1.0f) {
  return {a, b, c, V3f(radiance), false, 0, {}};
}

TEST(Rectangles, finds_the_pair_in_any_rotation) {
  for (int first = 0; first < 3; ++first) {
    for (int second = 0; second < 3; ++second) {
      const TriangleKey a = {kA, kB, kC}, b = {kA, kC, kD};
      const auto turned = [](const TriangleKey& key, int by) {
        return triangle(key[by], key[(by + 1) % 3], key[(by + 2) % 3]);
      };
      const std::vector<EmissiveTriangle> pair = {turned(a, first), turned(b, second)};
      const auto found = find_rectangles(pair, {});
      ASSERT_EQ(found.size(), 1u) << first << second;
      ASSERT_TRUE(found[0].rectangle);
      const AreaShape shape = found[0].shape({pair[0].p0, pair[0].p1, pair[0].p2});
      EXPECT_EQ(shape.p0, kB);
      EXPECT_EQ(shape.edge1, kC - kB);
      EXPECT_EQ(shape.edge2, kA - kB);
    }
  }
}

TEST(Rectangles, leaves_other_pairs_alone) {
  const EmissiveTriangle half = triangle(kA, kB, kC);
  const V3f aside(0.01f, 0, 0);
  EmissiveTriangle both_sides = triangle(kA, kC, kD);
  both_sides.two_sided = true;
  const std::vector<EmissiveTriangle> others = {
      triangle(kA, kC, kD, 2.0f),   both_sides,                          // of another emission
      triangle(kC, kA, kD),                                              // facing the other way
      triangle(kA, kC, kD + aside), triangle(kA, kC, V3f(-1, 1.1f, 1)),  // no rectangle, folded
      triangle(kA, kD, kD),         triangle(V3f(NAN), kC, kD)};
  for (const EmissiveTriangle& other : others) {
    const auto found = find_rectangles(std::vector{half, other}, {});
    ASSERT_EQ(found.size(), 2u);
    EXPECT_FALSE(found[0].rectangle || found[1].rectangle);
  }
  // A sheared one.
  const V3f shear(0.5f, 0, 0);
  EXPECT_EQ(
      find_rectangles(std::vector{triangle(kA, kB, kC + shear), triangle(kA, kC + shear, kD + shear)}, {})
          .size(),
      2u);
}

TEST(Rectangles, moving_ones_are_rectangles_at_all_keys) {
  const V3f up(0, 1, 0), shear(0.5f, 0, 0);
  for (const bool stays : {true, false}) {
    const V3f last_c = kC + up + (stays ? V3f(0) : shear), last_d = kD + up + (stays ? V3f(0) : shear);
    const std::vector<TriangleKey> keys = {
        {kA, kB, kC}, {kA + up, kB + up, last_c}, {kA, kC, kD}, {kA + up, last_c, last_d}};
    std::vector<EmissiveTriangle> pair = {triangle(kA, kB, kC), triangle(kA, kC, kD)};
    pair[0].motion = {0, 1};
    pair[1].motion = {2, 1};
    EXPECT_EQ(find_rectangles(pair, keys).size(), stays ? 1u : 2u);
  }
}

}  // namespace
}  // namespace becalm::tracer
