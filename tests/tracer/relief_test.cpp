// Bump and normal maps against the normals of the displaced surfaces.
#include "tracer/scene/relief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/tracer/test_images.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

constexpr int kSize = 64;

struct Relief {
  Textures textures;
  Material material;

  V3f normal(const ReliefPoint& point) const {
    return perturbed_normal(material, Textures::Reader(textures), point);
  }
};

/// Heights of a function of (u, v).
template <class Height>
Relief bumps(float scale, const Height& height) {
  std::vector<float> pixels;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      pixels.push_back(
          height((static_cast<float>(x) + 0.5f) / kSize, 1.0f - (static_cast<float>(y) + 0.5f) / kSize));
    }
  }
  Relief relief;
  const std::string path = write_image("height.exr", kSize, kSize, 1, pixels);
  relief.material.bump = BumpMap{relief.textures.add({.path = path, .content = TextureContent::r}), scale};
  return relief;
}

Relief normals(const V3f& rgb, float strength = 1.0f) {
  Relief relief;
  const std::string path = write_image("normal.exr", 1, 1, 3, {rgb.x, rgb.y, rgb.z});
  relief.material.normal_map =
      NormalMap{relief.textures.add({.path = path, .content = TextureContent::data}), strength};
  return relief;
}

const ReliefPoint kFlat{{{0.4f, 0.6f}}, V3f(2, 0, 0), V3f(0, 3, 0), V3f(0, 0, 1), V3f(0, 0, 1)};

/// A ramp on a plane of 2 by 3 units, tilted, mirrored and skewed: the normal is that of the raised plane.
TEST(Relief, ARampTurnsThePlane) {
  const float scale = 0.7f, slope_u = 0.8f, slope_v = -0.3f;
  const Relief relief = bumps(scale, [&](float u, float v) { return slope_u * u + slope_v * v; });
  const V3f tilted = V3f(0.3f, -0.5f, 0.8f).normalized();
  const V3f across = tilted.cross(V3f(0, 1, 0)).normalized();
  for (const float mirrored : {1.0f, -1.0f}) {
    for (const float footprint : {0.0f, 0.02f, 0.1f}) {
      const V3f dpdu = across * 2.0f, dpdv = (tilted.cross(across) * 3.0f + across * 0.5f) * mirrored;
      // Of p(u, v) + scale h(u, v) n, on the side of n.
      V3f expected =
          (dpdu + tilted * (scale * slope_u)).cross(dpdv + tilted * (scale * slope_v)).normalized();
      if (expected.dot(tilted) < 0.0f) expected = -expected;
      const V3f normal =
          relief.normal({{{0.5f, 0.5f}, {footprint, 0.0f}, {0.0f, footprint}}, dpdu, dpdv, tilted, tilted});
      EXPECT_NEAR((normal - expected).length(), 0.0f, 2e-5f) << mirrored << " " << footprint;
    }
  }
}

TEST(Relief, WavesFollowTheirSlopeAndFadeWithDistance) {
  const float waves = 4.0f, scale = 0.05f;
  const float angular = 2.0f * std::numbers::pi_v<float> * waves;
  const Relief relief = bumps(scale, [&](float u, float) { return std::sin(angular * u); });
  ReliefPoint point = kFlat;
  for (const float u : {0.1f, 0.25f, 0.37f, 0.9f}) {
    point.texture = {{u, 0.5f}};
    const float slope = scale * angular * std::cos(angular * u) / 2.0f;  // dpdu has length 2
    const V3f expected = V3f(-slope, 0.0f, 1.0f).normalized();
    EXPECT_NEAR((relief.normal(point) - expected).length(), 0.0f, 0.02f) << u;
    point.texture = {{u, 0.5f}, {0.5f, 0.0f}, {0.0f, 0.5f}};
    EXPECT_NEAR((relief.normal(point) - V3f(0, 0, 1)).length(), 0.0f, 0.02f) << "from afar, at " << u;
  }
}

TEST(Relief, AFlatNormalMapChangesNothing) {
  const Relief relief = normals({0.5f, 0.5f, 1.0f});
  const V3f shading = V3f(0.2f, 0.1f, 0.9f).normalized();
  const V3f normal = relief.normal({{{0.1f, 0.2f}}, V3f(2, 0.3f, 0), V3f(0, 3, 0.1f), shading, V3f(0, 0, 1)});
  EXPECT_NEAR((normal - shading).length(), 0.0f, 1e-6f);
}

TEST(Relief, NormalMapsPointAlongUAndUpV) {
  const auto turned = [](const V3f& rgb, const V3f& dpdu, const V3f& dpdv, float strength = 1.0f) {
    return normals(rgb, strength).normal({{{0.5f, 0.5f}}, dpdu, dpdv, V3f(0, 0, 1), V3f(0, 0, 1)});
  };
  const float diagonal = std::sqrt(0.5f);
  const V3f along_x(0.5f + 0.5f * diagonal, 0.5f, 0.5f + 0.5f * diagonal);
  const V3f along_y(0.5f, 0.5f + 0.5f * diagonal, 0.5f + 0.5f * diagonal);
  const V3f x(5, 0, 0), y(0, 5, 0);
  EXPECT_LT((turned(along_x, x, y) - V3f(diagonal, 0, diagonal)).length(), 1e-6f);
  EXPECT_LT((turned(along_y, x, y) - V3f(0, diagonal, diagonal)).length(), 1e-6f);
  EXPECT_LT((turned(along_y, x, -y) - V3f(0, -diagonal, diagonal)).length(), 1e-6f) << "mirrored uvs";
  EXPECT_LT((turned(along_x, y, -x) - V3f(0, diagonal, diagonal)).length(), 1e-6f) << "turned uvs";
  EXPECT_LT((turned(along_x, x, y, 0.0f) - V3f(0, 0, 1)).length(), 1e-6f);
  EXPECT_LT((turned(along_x, x, y, 2.0f) - V3f(2, 0, 1).normalized()).length(), 1e-6f);
}

TEST(Relief, DegenerateTangentsLeaveTheNormal) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinity = std::numeric_limits<float>::infinity();
  const Relief maps[] = {normals({0.9f, 0.6f, 0.7f}), bumps(5.0f, [](float u, float v) { return u * v; })};
  for (const Relief& relief : maps) {
    for (const auto& [u, v] :
         {std::pair(V3f(0.0f), V3f(0.0f)), std::pair(V3f(1, 0, 0), V3f(0.0f)),
          std::pair(V3f(1, 2, 0), V3f(-2, -4, 0)), std::pair(V3f(0, 0, 1), V3f(0, 1, 0)),
          std::pair(V3f(nan), V3f(0, 1, 0)), std::pair(V3f(infinity, 0, 0), V3f(0, 1, 0))}) {
      ReliefPoint point = kFlat;
      point.dpdu = u;
      point.dpdv = v;
      EXPECT_EQ(relief.normal(point), V3f(0, 0, 1)) << u << " " << v;
    }
    ReliefPoint plain = kFlat;
    for (const float scale : {1e-30f, 1e30f}) {
      plain.dpdu = V3f(scale, 0, 0);
      plain.dpdv = V3f(0, scale, 0);
      EXPECT_NEAR(relief.normal(plain).length(), 1.0f, 1e-5f) << scale;
    }
  }
  Relief none;
  EXPECT_EQ(none.normal(kFlat), V3f(0, 0, 1)) << "no maps";
}

TEST(Relief, StaysOnTheSideOfTheGeometricNormal) {
  // A map that points below the surface.
  const V3f geometric = V3f(-0.3f, 0.0f, 1.0f).normalized();
  const V3f normal = normals({1.0f, 0.5f, 0.4f})
                         .normal({{{0.5f, 0.5f}}, V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1), geometric});
  EXPECT_GT(normal.dot(geometric), 0.0f);
  EXPECT_NEAR(normal.length(), 1.0f, 1e-6f);
  const V3f steep = bumps(1e30f, [](float u, float) { return u; }).normal(kFlat);
  EXPECT_TRUE(is_finite(steep));
  EXPECT_GT(steep.z, 0.0f);
}

}  // namespace
}  // namespace becalm::tracer::test
