#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "tracer/lights/light_sample.h"
#include "tracer/lights/motion_keys.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Emits `radiance` from the side from which p0, p1, p2 appear counter-clockwise, or from both.
struct EmissiveTriangle {
  V3f p0, p1, p2;
  V3f radiance;
  bool two_sided = false;
  std::uint16_t group = 0;
  MotionKeys motion = {};  ///< among LightList::triangle_keys
};

/// A place of a moving triangle: its corners.
using TriangleKey = std::array<V3f, 3>;

/// An emissive triangle, prepared for sampling uniformly by area.
struct AreaLight {
  V3f p0, edge1, edge2;
  V3f normal;   ///< unit, on the emitting side; 0 without area
  double area;  ///< 0 when degenerate or not finite; double, since squares of edges leave the range of float
  V3f radiance;
  bool two_sided;
  std::uint16_t group;

  explicit AreaLight(const EmissiveTriangle& triangle)
      : p0(triangle.p0),
        edge1(triangle.p1 - triangle.p0),
        edge2(triangle.p2 - triangle.p0),
        radiance(triangle.radiance),
        two_sided(triangle.two_sided),
        group(triangle.group) {
    const V3d cross = V3d(edge1).cross(V3d(edge2));
    const double length = cross.length();
    const bool usable = length > 0.0 && std::isfinite(length);
    area = usable ? 0.5 * length : 0.0;
    normal = usable ? V3f(cross / length) : V3f(0.0f);
  }

  /// Emitted flux, mean of the channels.
  double power() const { return std::numbers::pi * area * channel_mean(radiance) * (two_sided ? 2.0 : 1.0); }

  /// Density per solid angle, seen from `distance` away along the unit direction `dir_world`, of points
  /// uniform by area: distance^2 / (|cos| area). 0 on the dark side, edge-on and beyond the range of float.
  float pdf_solid_angle(const V3f& dir_world, float distance) const {
    const float cos_light = -normal.dot(dir_world);
    if (area == 0.0 || cos_light == 0.0f || (cos_light < 0.0f && !two_sided)) return 0.0f;
    const double squared = static_cast<double>(distance) * distance;
    const double pdf = squared / (static_cast<double>(std::abs(cos_light)) * area);
    return pdf <= std::numeric_limits<float>::max() ? static_cast<float>(pdf) : 0.0f;
  }

  /// A point uniform by area, as a direction from `point`; nothing where pdf_solid_angle would be 0.
  std::optional<LightSample> sample(const V3f& point, const V2f& u) const {
    // The square's halves on either side of its diagonal shear into the triangle's (Heitz, "A Low-Distortion
    // Map Between Triangle and Square", 2019): stratified u stay stratified.
    const bool above = u.y > u.x;
    const float b0 = above ? 0.5f * u.x : u.x - 0.5f * u.y;
    const float b1 = above ? u.y - 0.5f * u.x : 0.5f * u.y;
    const V3f position = p0 + edge1 * b1 + edge2 * (1.0f - b0 - b1);
    const V3d to_light = V3d(position) - V3d(point);
    const double distance = to_light.length();
    if (!(distance > 0.0)) return std::nullopt;
    const V3f dir_world(to_light / distance);
    const float pdf = pdf_solid_angle(dir_world, static_cast<float>(distance));
    if (pdf == 0.0f) return std::nullopt;
    return LightSample{
        dir_world,
        static_cast<float>(distance),
        radiance,
        pdf,
        group,
        false,
        std::max({largest_coordinate(p0), largest_coordinate(p0 + edge1), largest_coordinate(p0 + edge2)})};
  }
};

}  // namespace becalm::tracer
