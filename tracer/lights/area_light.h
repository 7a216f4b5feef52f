#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "tracer/lights/bilinear_warp.h"
#include "tracer/lights/irradiance.h"
#include "tracer/lights/light_sample.h"
#include "tracer/lights/motion_keys.h"
#include "tracer/lights/receiver.h"
#include "tracer/lights/spherical_rectangle.h"
#include "tracer/lights/spherical_triangle.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Emits `radiance` from the side from which p0, p1, p2 appear counter-clockwise, or from both.
struct EmissiveTriangle {
  V3f p0, p1, p2;
  V3f radiance;
  bool two_sided = false;
  std::uint16_t group = 0;
  MotionKeys motion = {};  ///< among LightList::triangle_keys
  float extent = 0.0f;     ///< what positions on it are rounded relative to, if more than its coordinates
};

/// A place of a moving triangle: its corners.
using TriangleKey = std::array<V3f, 3>;

/// Where an area light is: the triangle p0, p0 + edge1, p0 + edge2, or the parallelogram of both edges.
struct AreaShape {
  V3f p0, edge1, edge2;
  bool quad = false;
};

/// An emissive triangle or parallelogram, prepared for sampling. What depends on the place of the receiver is
/// worked out in double.
///
/// Triangles are sampled uniformly by solid angle, from afar by area. Parallelograms farther away than their
/// diagonal are sampled by area, with a density that is bilinear between what the receiver gets from their
/// corners; nearer ones, if rectangles, by solid angle, with one that is bilinear between the receiver's
/// cosines at the corners.
struct AreaLight {
  V3f p0, edge1, edge2;
  bool quad;
  bool right_angled;        ///< between the edges
  V3f normal;               ///< unit, on the emitting side; 0 without area
  double length1, length2;  ///< of the edges
  double inverse_length1, inverse_length2;
  V3d dual1, dual2;  ///< shares of the edges in an offset from p0 within the plane, by dot products
  double area;  ///< 0 when degenerate or not finite; double, since squares of edges leave the range of float
  V3f radiance;
  bool two_sided;
  std::uint16_t group;
  float extent;  ///< what positions on it are rounded relative to: at least its largest coordinate

  AreaLight(const AreaShape& shape, const V3f& emitted, bool both_sides, std::uint16_t light_group,
            float least_extent = 0.0f)
      : p0(shape.p0),
        edge1(shape.edge1),
        edge2(shape.edge2),
        quad(shape.quad),
        length1(V3d(edge1).length()),
        length2(V3d(edge2).length()),
        inverse_length1(1.0 / length1),
        inverse_length2(1.0 / length2),
        radiance(emitted),
        two_sided(both_sides),
        group(light_group),
        extent(std::max({least_extent, largest_coordinate(p0), largest_coordinate(p0 + edge1),
                         largest_coordinate(p0 + edge2),
                         quad ? largest_coordinate(p0 + edge1 + edge2) : 0.0f})) {
    const V3d e1(edge1), e2(edge2);
    const V3d cross = e1.cross(e2);
    const double length = cross.length();
    const bool usable = length > 0.0 && std::isfinite(length);
    area = usable ? (quad ? length : 0.5 * length) : 0.0;
    normal = usable ? V3f(cross / length) : V3f(0.0f);
    constexpr double least_cosine = 1e-4;  // rounding of coordinates leaves as much
    right_angled = quad && std::abs(e1.dot(e2)) <= least_cosine * length;
    dual1 = usable ? e2.cross(cross) / (length * length) : V3d(0.0);
    dual2 = usable ? cross.cross(e1) / (length * length) : V3d(0.0);
  }

  explicit AreaLight(const EmissiveTriangle& triangle)
      : AreaLight({triangle.p0, triangle.p1 - triangle.p0, triangle.p2 - triangle.p0}, triangle.radiance,
                  triangle.two_sided, triangle.group, triangle.extent) {}

  /// Radiant intensity along the normal, mean of the channels.
  double radiant_intensity() const { return area * channel_mean(radiance); }

  /// What arrives at the receiver if nothing is in between, as irradiance.h has it; 0 where sample() gives
  /// nothing.
  double irradiance_at(const Receiver& at) const;

  /// Whether that is not 0.
  bool reaches(const Receiver& at) const { return reaches(at, view(at)); }

  /// Density per solid angle with which sample() finds the unit direction `dir_world`, in which the light is
  /// `distance` away. 0 on the dark side, edge-on and beyond the range of float.
  float pdf_solid_angle(const Receiver& at, const V3f& dir_world, float distance) const;

  /// A point as a direction from the receiver; nothing where pdf_solid_angle would be 0.
  std::optional<LightSample> sample(const Receiver& at, const V2f& u) const;

 private:
  /// Triangles farther away than this many roots of their area are sampled by area: the density hardly
  /// differs.
  static constexpr double kFar = 20.0;
  /// Below this many steradians the closed forms lose their digits.
  static constexpr double kLeastSolidAngle = 1e-6;

  /// A triangle or parallelogram as a receiver sees it.
  struct View {
    V3d to_p0;
    double squared;  ///< distance of the centre
    double height;   ///< of the receiver above the plane; 0 where nothing of the light arrives
  };
  View view(const Receiver& at) const;
  bool reaches(const Receiver& at, const View& view) const;

  /// Whether the cosines and distances of its points differ by much.
  bool is_near(const View& view) const {
    return view.squared < (quad ? length1 * length1 + length2 * length2 : kFar * kFar * area);
  }

  SphericalRectangle seen_rectangle(const View& view, const V2d& corner) const {
    return {corner.x, corner.x + length1, corner.y, corner.y + length2, view.height};
  }
  /// p0 as seen from below the receiver, along the edges.
  V2d corner(const View& view) const {
    return {view.to_p0.dot(V3d(edge1)) * inverse_length1, view.to_p0.dot(V3d(edge2)) * inverse_length2};
  }
  /// The cosine of the receiver over the map of a rectangle.
  BilinearWarp cosine(const Receiver& at, const View& view, const SphericalRectangle& map) const;
  /// What the receiver gets from a parallelogram, over its area.
  BilinearWarp received(const Receiver& at, const View& view) const;

  SphericalTriangle seen_triangle(const View& view) const {
    return {view.to_p0.normalized(), (view.to_p0 + V3d(edge1)).normalized(),
            (view.to_p0 + V3d(edge2)).normalized()};
  }

  /// Of points that are uniform by area.
  double density_of_area(const V3f& dir_world, double distance) const {
    const double cosine = std::abs(normal.dot(dir_world));
    return distance * distance / (cosine * area);
  }

  static float in_range(double pdf) {
    return pdf <= std::numeric_limits<float>::max() ? static_cast<float>(pdf) : 0.0f;
  }
};

}  // namespace becalm::tracer
