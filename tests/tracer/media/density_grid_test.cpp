#include "tracer/media/density_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tracer/media/test_media.h"
#include "tracer/media/cloud_shape.h"

namespace becalm::tracer {
namespace {

template <class Visit>
void for_each_block(const DensityGrid& grid, const Visit& visit) {
  for (int z = 0; z < grid.blocks().z; ++z) {
    for (int y = 0; y < grid.blocks().y; ++y) {
      for (int x = 0; x < grid.blocks().x; ++x) visit(V3i(x, y, z));
    }
  }
}

/// White noise: nothing bounds a value by its neighbours'.
DensityGrid noise_grid(const V3i& size) {
  TestRandom random(30);
  std::vector<float> values(static_cast<std::size_t>(size.x) * size.y * size.z);
  for (float& value : values) value = random.next() < 0.01f ? random.next() : 0.1f * random.next();
  return {size, std::move(values)};
}

TEST(DensityGrid, MajorantIsTheLargestCornerAndNeverExceeded) {
  for (const V3i& size : {V3i(2, 2, 2), V3i(9, 9, 9), V3i(10, 17, 8), V3i(21, 3, 33)}) {
    const DensityGrid grid = noise_grid(size);
    TestRandom random(31);
    for_each_block(grid, [&](const V3i& block) {
      float largest = 0.0f;
      const V3i first = block * DensityGrid::kBlockCells;
      const V3i last(std::min(first.x + 8, size.x - 1), std::min(first.y + 8, size.y - 1),
                     std::min(first.z + 8, size.z - 1));
      for (int z = first.z; z <= last.z; ++z) {
        for (int y = first.y; y <= last.y; ++y) {
          for (int x = first.x; x <= last.x; ++x) {
            largest = std::max(largest, grid.value(x, y, z));
            const V3f corner(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
            ASSERT_EQ(grid.density_in_block(block, corner), grid.value(x, y, z));
            const V3f p = corner + V3f(random.next(), random.next(), random.next());
            ASSERT_LE(grid.density_in_block(block, p), grid.majorant(block));
          }
        }
      }
      ASSERT_NEAR(grid.majorant(block), largest, 2e-6f * largest);
      // What rounding put beside the block counts as its nearest point.
      ASSERT_EQ(grid.density_in_block(block, V3f(last) + V3f(0.5f)), grid.value(last.x, last.y, last.z));
      ASSERT_EQ(grid.density_in_block(block, V3f(first) - V3f(3.0f)), grid.value(first.x, first.y, first.z));
    });
    EXPECT_GE(grid.bytes(), static_cast<std::size_t>(size.x) * size.y * size.z * sizeof(float));
  }
}

TEST(DensityGrid, InterpolatesLinearFunctionsExactly) {
  const V3i size(12, 9, 20);
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) values.push_back(static_cast<float>(x + 100 * y + 10000 * z));
    }
  }
  const DensityGrid grid(size, std::move(values));
  const V3f p(9.25f, 6.5f, 17.75f);
  EXPECT_NEAR(grid.density_in_block(V3i(1, 0, 2), p), 9.25f + 650.0f + 177500.0f, 0.1f);
}

/// The blocks that a traversal visits cover the span: every point of it lies in the block visited there, and
/// the gaps are blocks without density.
TEST(DensityGrid, TraversalCoversTheSpanInOrder) {
  const DensityGrid grid = lumpy_grid();
  TestRandom random(32);
  const V3f size(grid.size() - V3i(1));
  int all_visits = 0;
  for (int i = 0; i < 3000; ++i) {
    V3f origin, dir;
    for (int a = 0; a < 3; ++a) {
      origin[a] = size[a] * (1.6f * random.next() - 0.3f);
      dir[a] = 2.0f * random.next() - 1.0f;
      if (i % 4 == 1 && random.next() < 0.6f) dir[a] = 0.0f;
      if (i % 4 == 2) origin[a] = std::round(origin[a] / 8.0f) * 8.0f;  // along and through the blocks' faces
      if (i % 4 == 3 && random.next() < 0.5f) dir[a] = 1e-30f;
    }
    const GridSpan span = clip_to_grid(grid, origin, dir, i % 5 == 0 ? 7.0f : kInfinity);
    if (is_black(dir)) continue;
    ASSERT_TRUE(std::isfinite(span.length) && span.length >= 0.0f);
    float at = 0.0f;
    int visits = 0;
    const auto expect_empty = [&](float from, float to) {
      if (to - from < 1e-4f) return;  // rounding
      for (int k = 1; k < 8; ++k) {
        const V3f p = span.origin + dir * (from + (to - from) * static_cast<float>(k) / 8.0f);
        V3i block;
        for (int a = 0; a < 3; ++a) {
          block[a] = std::clamp(static_cast<int>(p[a] / 8.0f), 0, grid.blocks()[a] - 1);
        }
        ASSERT_LT(grid.density_in_block(block, p), 1e-4f) << "ray " << i;
      }
    };
    visit_blocks(grid, span, [&](const V3i& block, float majorant, float t_in, float t_out) {
      EXPECT_EQ(majorant, grid.majorant(block));
      EXPECT_GT(t_out, t_in);
      EXPECT_GE(t_in, at);
      expect_empty(at, t_in);
      const V3f middle = span.origin + dir * (0.5f * (t_in + t_out));
      for (int a = 0; a < 3; ++a) {
        EXPECT_GE(middle[a], static_cast<float>(block[a] * 8) - 1e-4f) << "ray " << i;
        EXPECT_LE(middle[a], static_cast<float>(block[a] * 8 + 8) + 1e-4f) << "ray " << i;
      }
      at = t_out;
      ++visits;
      return true;
    });
    expect_empty(at, span.length);
    ASSERT_LE(visits, grid.blocks().x + grid.blocks().y + grid.blocks().z);
    all_visits += visits;
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(all_visits, 3000);
}

TEST(DensityGrid, RaysBesideTheBoxHaveNoSpan) {
  const DensityGrid grid = lumpy_grid();
  EXPECT_EQ(clip_to_grid(grid, V3f(-1, 5, 5), V3f(-1, 0, 0), kInfinity).length, 0.0f);
  EXPECT_EQ(clip_to_grid(grid, V3f(-1, 5, 5), V3f(0, 1, 0), kInfinity).length, 0.0f);
  EXPECT_EQ(clip_to_grid(grid, V3f(-5, 5, 5), V3f(1, 0, 0), 4.0f).length, 0.0f);
  EXPECT_EQ(clip_to_grid(grid, V3f(-5, 5, 5), V3f(1, 0, 0), 7.0f).length, 2.0f);
  EXPECT_EQ(clip_to_grid(grid, V3f(-5, 5, 5), V3f(1, 0, 0), 7.0f).offset, 5.0f);
  EXPECT_EQ(clip_to_grid(grid, V3f(NAN, 5, 5), V3f(1, 0, 0), 7.0f).length, 0.0f);
  EXPECT_EQ(clip_to_grid(grid, V3f(5, 5, 5), V3f(1, NAN, 0), 7.0f).length, 0.0f);
  EXPECT_EQ(clip_to_grid(grid, V3f(kInfinity, 5, 5), V3f(-1, 0, 0), kInfinity).length, 0.0f);
}

}  // namespace
}  // namespace becalm::tracer
