#include "tracer/lights/area_light.h"

#include <numbers>

namespace becalm::tracer {

namespace {

/// A triangle's point from the unit square: the halves on either side of the diagonal shear into the
/// triangle's (Heitz, "A Low-Distortion Map Between Triangle and Square", 2019), so that stratified u stay
/// stratified. The weights of p1 and p2.
V2d square_to_triangle(const V2f& u) {
  const bool above = u.y > u.x;
  const float b0 = above ? 0.5f * u.x : u.x - 0.5f * u.y;
  const float b1 = above ? u.y - 0.5f * u.x : 0.5f * u.y;
  return {b1, 1.0f - b0 - b1};
}

}  // namespace

AreaLight::View AreaLight::view(const Receiver& at) const {
  const V3d to_p0 = V3d(p0) - V3d(at.position);
  const V3d to_center = to_p0 + (V3d(edge1) + V3d(edge2)) * (quad ? 0.5 : 1.0 / 3.0);
  const double above = -V3d(normal).dot(to_center);
  const double squared = to_center.dot(to_center);
  // Rounding hides the side of a receiver that is almost in the plane, as on the light itself.
  constexpr double least_sine_squared = 1e-12;
  const bool lit = (above > 0.0 || two_sided) && above * above > least_sine_squared * (squared + area) &&
                   std::isfinite(squared);
  return {to_p0, area > 0.0 && lit ? std::abs(above) : 0.0, !(squared <= kFar * kFar * area)};
}

BilinearWarp AreaLight::cosine(const Receiver& at, const View& view, const SphericalRectangle& map) const {
  // What the corners do not tell of the inside must still be drawn at times.
  constexpr double least_cosine = 0.01;
  const V3d n(at.normal);
  const double at_p0 = n.dot(view.to_p0), along1 = n.dot(V3d(edge1)), along2 = n.dot(V3d(edge2));
  std::array<double, 4> cosines = {at_p0, at_p0 + along1, at_p0 + along2, at_p0 + along1 + along2};
  for (std::size_t i = 0; i < 4; ++i) cosines[i] = std::max(cosines[i] / map.distances()[i], least_cosine);
  return BilinearWarp(cosines);
}

double AreaLight::irradiance_at(const Receiver& at) const {
  const View seen = view(at);
  if (!(seen.height > 0.0)) return 0.0;
  const V3d &p = seen.to_p0, e1(edge1), e2(edge2), n(at.normal);
  if (at.faces()) {
    const double along1 = n.dot(e1), along2 = n.dot(e2);
    const double highest =
        quad ? std::max(along1, 0.0) + std::max(along2, 0.0) : std::max({along1, along2, 0.0});
    if (n.dot(p) + highest <= 0.0) return 0.0;
  }
  const double mean = channel_mean(radiance);
  const V3d to_center = p + (e1 + e2) * (quad ? 0.5 : 1.0 / 3.0);
  const double squared = to_center.dot(to_center);
  // Farther than twice the diagonal all shapes are as good as a disc.
  if (squared < 2.0 * (length1 * length1 + length2 * length2))
    return mean * polygon_irradiance(at, {p, p + e1, quad ? p + e1 + e2 : p + e2, p + e2});
  const double inverse = 1.0 / std::sqrt(squared);
  const double disc = area * seen.height * inverse / (std::numbers::pi * squared + area);
  return mean * irradiance_of_outline(at, disc, to_center * inverse);
}

float AreaLight::pdf_solid_angle(const Receiver& at, const V3f& dir_world, float distance) const {
  const View seen = view(at);
  if (!(seen.height > 0.0)) return 0.0f;
  if (!seen.far && right_angled) {
    const SphericalRectangle map = seen_rectangle(seen, corner(seen));
    if (map.solid_angle() > kLeastSolidAngle) {
      if (!at.faces()) return in_range(1.0 / map.solid_angle());
      const V3d dir(dir_world);
      const double reach = seen.height / std::abs(V3d(normal).dot(dir));
      const V2d point(dir.dot(V3d(edge1)) * inverse_length1, dir.dot(V3d(edge2)) * inverse_length2);
      return in_range(cosine(at, seen, map).density(map.invert(point * reach)) / map.solid_angle());
    }
  } else if (!seen.far && !quad) {
    const double solid_angle = seen_triangle(seen).solid_angle();
    if (solid_angle > kLeastSolidAngle) return in_range(1.0 / solid_angle);
  }
  return pdf_by_area(dir_world, distance);
}

std::optional<LightSample> AreaLight::sample(const Receiver& at, const V2f& u) const {
  const View seen = view(at);
  if (!(seen.height > 0.0)) return std::nullopt;
  const V3d e1(edge1), e2(edge2);
  V2d shares = quad ? V2d(u) : square_to_triangle(u);  // of the edges
  double density = 0.0;                                // if not by area
  if (!seen.far && right_angled) {
    const V2d from = corner(seen);
    const SphericalRectangle map = seen_rectangle(seen, from);
    if (map.solid_angle() > kLeastSolidAngle) {
      V2d warped(u);
      density = 1.0 / map.solid_angle();
      if (at.faces()) {
        const BilinearWarp warp = cosine(at, seen, map);
        warped = warp.sample(u);
        density *= warp.density(warped);
      }
      shares = (map.sample(warped) - from) * V2d(inverse_length1, inverse_length2);
    }
  } else if (!seen.far && !quad) {
    const SphericalTriangle map = seen_triangle(seen);
    if (map.solid_angle() > kLeastSolidAngle) {
      density = 1.0 / map.solid_angle();
      // Where the direction meets the plane.
      const V3d dir = map.sample(u);
      const double scale = 1.0 / dir.dot(e1.cross(e2));
      shares.x = std::clamp(-dir.dot(seen.to_p0.cross(e2)) * scale, 0.0, 1.0);
      shares.y = std::clamp(dir.dot(seen.to_p0.cross(e1)) * scale, 0.0, 1.0 - shares.x);
    }
  }
  const V3d to_light = seen.to_p0 + e1 * shares.x + e2 * shares.y;
  const double distance = std::sqrt(to_light.dot(to_light));
  if (!(distance > 0.0)) return std::nullopt;
  const V3f dir_world(to_light * (1.0 / distance));
  const float pdf = density > 0.0 ? in_range(density) : pdf_by_area(dir_world, static_cast<float>(distance));
  if (!(pdf > 0.0f)) return std::nullopt;
  const float extent =
      std::max({largest_coordinate(p0), largest_coordinate(p0 + edge1), largest_coordinate(p0 + edge2),
                quad ? largest_coordinate(p0 + edge1 + edge2) : 0.0f});
  return LightSample{dir_world, static_cast<float>(distance), radiance, pdf, group, false, extent};
}

}  // namespace becalm::tracer
