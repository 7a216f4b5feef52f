#include "tracer/scene/shapes.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

namespace becalm::tracer {
namespace {

V3f cross_of(const Mesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
}

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) sum += 0.5 * cross_of(mesh, i).length();
  return sum;
}

void expect_consistent(const Mesh& mesh) {
  EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
  EXPECT_EQ(mesh.uvs.size(), mesh.positions.size());
  for (const V2f& uv : mesh.uvs) {
    EXPECT_TRUE(uv.x >= 0.0f && uv.x <= 1.0f && uv.y >= 0.0f && uv.y <= 1.0f);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) ASSERT_LT(vertex, mesh.positions.size());
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) EXPECT_GT(cross_of(mesh, i).length(), 0.0f);
}

TEST(Shapes, RectangleAndDiscFaceUp) {
  for (const Mesh& mesh : {make_rectangle(), make_disc(5), make_disc(64)}) {
    expect_consistent(mesh);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const V3f normal = cross_of(mesh, i).normalized();
      EXPECT_NEAR(normal.y, 1.0f, 1e-6f);
    }
  }
  EXPECT_NEAR(area(make_rectangle()), 4.0, 1e-6);
  EXPECT_NEAR(area(make_disc(7)), std::numbers::pi, 1e-5);
  EXPECT_NEAR(area(make_disc(64)), std::numbers::pi, 1e-5);
}

TEST(Shapes, CubeAndSphereAreClosedAndFaceOutward) {
  for (const Mesh& mesh : {make_cube(), make_sphere(3), make_sphere(17), make_sphere(64)}) {
    expect_consistent(mesh);
    // In a closed surface every edge, by the positions of its ends, is passed once in each direction.
    std::map<std::array<float, 6>, int> edges;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      EXPECT_GT(cross_of(mesh, i).dot(mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]),
                0.0f);
      for (int k = 0; k < 3; ++k) {
        const V3f &a = mesh.positions[t[k]], &b = mesh.positions[t[(k + 1) % 3]];
        // + 0.0f makes one of the two zeros.
        ++edges[{a.x + 0.0f, a.y + 0.0f, a.z + 0.0f, b.x + 0.0f, b.y + 0.0f, b.z + 0.0f}];
        --edges[{b.x + 0.0f, b.y + 0.0f, b.z + 0.0f, a.x + 0.0f, a.y + 0.0f, a.z + 0.0f}];
      }
    }
    for (const auto& [edge, balance] : edges) EXPECT_EQ(balance, 0);
  }
  EXPECT_NEAR(area(make_cube()), 24.0, 1e-5);
  EXPECT_NEAR(area(make_sphere(128)), 4.0 * std::numbers::pi, 0.02);
}

}  // namespace
}  // namespace becalm::tracer
