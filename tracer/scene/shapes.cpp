#include "tracer/scene/shapes.h"

#include <cassert>
#include <numbers>

namespace becalm::tracer {

namespace {

using std::numbers::pi;

/// The rectangle centre +- right +- up, facing right x up, with uv along them.
void add_quad(Mesh& mesh, const V3f& center, const V3f& right, const V3f& up) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(),
                        {center - right - up, center + right - up, center + right + up, center - right + up});
  mesh.uvs.insert(mesh.uvs.end(), {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

Mesh make_rectangle() {
  Mesh mesh;
  add_quad(mesh, V3f(0), V3f(1, 0, 0), V3f(0, 0, -1));
  return mesh;
}

Mesh make_disc(int segments) {
  assert(segments >= 3);
  Mesh mesh;
  // An n-gon of circumradius r has the area n/2 r^2 sin(2 pi/n); this r gives pi, so that a disc light has
  // its power.
  const double radius = std::sqrt(2.0 * pi / (segments * std::sin(2.0 * pi / segments)));
  mesh.positions.push_back(V3f(0));
  mesh.uvs.emplace_back(0.5f, 0.5f);
  for (int i = 0; i < segments; ++i) {
    const double angle = 2.0 * pi * i / segments;
    const double x = std::cos(angle), z = -std::sin(angle);
    mesh.positions.emplace_back(static_cast<float>(radius * x), 0.0f, static_cast<float>(radius * z));
    mesh.uvs.emplace_back(static_cast<float>(0.5 + 0.5 * x), static_cast<float>(0.5 - 0.5 * z));
    mesh.triangles.push_back(
        {0u, static_cast<std::uint32_t>(1 + i), static_cast<std::uint32_t>(1 + (i + 1) % segments)});
  }
  return mesh;
}

Mesh make_sphere(int segments) {
  assert(segments >= 3);
  Mesh mesh;
  const int around = segments, rows = std::max(2, segments / 2);
  for (int row = 0; row <= rows; ++row) {
    const double theta = pi * row / rows;  // from the north pole
    for (int i = 0; i <= around; ++i) {    // the seam's vertices are doubled, for their uv
      const double phi = 2.0 * pi * (i % around) / around;
      const double ring = row == 0 || row == rows ? 0.0 : std::sin(theta);
      const V3f p(static_cast<float>(ring * std::sin(phi)), static_cast<float>(std::cos(theta)),
                  static_cast<float>(ring * std::cos(phi)));
      mesh.positions.push_back(p);
      mesh.normals.push_back(p);
      mesh.uvs.emplace_back(static_cast<float>(i) / around, 1.0f - static_cast<float>(row) / rows);
    }
  }
  const auto vertex = [around](int row, int i) { return static_cast<std::uint32_t>(row * (around + 1) + i); };
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < around; ++i) {
      if (row + 1 < rows)
        mesh.triangles.push_back({vertex(row, i), vertex(row + 1, i), vertex(row + 1, i + 1)});
      if (row > 0) mesh.triangles.push_back({vertex(row, i), vertex(row + 1, i + 1), vertex(row, i + 1)});
    }
  }
  return mesh;
}

Mesh make_cube() {
  Mesh mesh;
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  add_quad(mesh, x, -z, y);
  add_quad(mesh, -x, z, y);
  add_quad(mesh, y, x, -z);
  add_quad(mesh, -y, x, z);
  add_quad(mesh, z, x, y);
  add_quad(mesh, -z, -x, y);
  return mesh;
}

}  // namespace becalm::tracer
