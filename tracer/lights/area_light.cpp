#include "tracer/lights/area_light.h"

#include <numbers>

namespace becalm::tracer {

namespace {

/// Least cosine of the receiver that counts at a corner: what the corners do not tell of the inside must
/// still be drawn at times.
constexpr double kLeastReceived = 0.01;

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
  // Rounding hides the side of a receiver that is almost in the plane, as on the light itself. What the light
  // sends there is left to the directions that the material draws.
  constexpr double least_sine_squared = 1e-12, rounding = 0x1p-20;
  const double least_height = rounding * std::max(extent, largest_coordinate(at.position));
  const bool lit = (above > 0.0 || two_sided) && std::abs(above) > least_height &&
                   above * above > least_sine_squared * (squared + area) && std::isfinite(squared);
  return {to_p0, squared, area > 0.0 && lit ? std::abs(above) : 0.0};
}

BilinearWarp AreaLight::cosine(const Receiver& at, const View& view, const SphericalRectangle& map) const {
  const V3d n(at.normal);
  const double at_p0 = n.dot(view.to_p0), along1 = n.dot(V3d(edge1)), along2 = n.dot(V3d(edge2));
  std::array<double, 4> cosines = {at_p0, at_p0 + along1, at_p0 + along2, at_p0 + along1 + along2};
  for (std::size_t i = 0; i < 4; ++i) cosines[i] = std::max(cosines[i] / map.distances()[i], kLeastReceived);
  return BilinearWarp(cosines);
}

BilinearWarp AreaLight::received(const Receiver& at, const View& view) const {
  const V3d &p = view.to_p0, e1(edge1), e2(edge2), n(at.normal);
  const std::array<V3d, 4> corners = {p, p + e1, p + e2, p + e1 + e2};
  const double least = kLeastReceived * std::sqrt(view.squared);
  std::array<double, 4> weights;
  for (std::size_t i = 0; i < 4; ++i) {
    // Both cosines over the squared distance are heights over its square; all but what differs is left out.
    const double ratio = view.squared / corners[i].length2();
    weights[i] = ratio * ratio * (at.faces() ? std::max(n.dot(corners[i]), least) : 1.0);
  }
  return BilinearWarp(weights);
}

bool AreaLight::reaches(const Receiver& at, const View& seen) const {
  if (!(seen.height > 0.0)) return false;
  if (!at.faces()) return true;
  const V3d n(at.normal);
  const double along1 = n.dot(V3d(edge1)), along2 = n.dot(V3d(edge2));
  const double highest =
      quad ? std::max(along1, 0.0) + std::max(along2, 0.0) : std::max({along1, along2, 0.0});
  return n.dot(seen.to_p0) + highest > 0.0;
}

double AreaLight::irradiance_at(const Receiver& at) const {
  const View seen = view(at);
  if (!reaches(at, seen)) return 0.0;
  const V3d &p = seen.to_p0, e1(edge1), e2(edge2);
  const double mean = channel_mean(radiance);
  const V3d to_center = p + (e1 + e2) * (quad ? 0.5 : 1.0 / 3.0);
  const double squared = seen.squared;
  // Farther than 1.4 times the diagonal all shapes are as good as a disc.
  if (squared < 2.0 * (length1 * length1 + length2 * length2))
    return mean * polygon_irradiance(at, {p, p + e1, quad ? p + e1 + e2 : p + e2, p + e2});
  const double inverse = 1.0 / std::sqrt(squared);
  const double disc = area * seen.height * inverse / (std::numbers::pi * squared + area);
  return mean * irradiance_of_outline(at, disc, to_center * inverse);
}

float AreaLight::pdf_solid_angle(const Receiver& at, const V3f& dir_world, float distance) const {
  const View seen = view(at);
  if (!(seen.height > 0.0)) return 0.0f;
  const V3d dir(dir_world);
  const double reach = seen.height / std::abs(V3d(normal).dot(dir));
  const bool near = is_near(seen);
  if (near && right_angled) {
    const SphericalRectangle map = seen_rectangle(seen, corner(seen));
    if (map.solid_angle() > kLeastSolidAngle) {
      if (!at.faces()) return in_range(1.0 / map.solid_angle());
      const V2d point(dir.dot(V3d(edge1)) * inverse_length1, dir.dot(V3d(edge2)) * inverse_length2);
      return in_range(cosine(at, seen, map).density(map.invert(point * reach)) / map.solid_angle());
    }
  } else if (near && !quad) {
    const double solid_angle = seen_triangle(seen).solid_angle();
    if (solid_angle > kLeastSolidAngle) return in_range(1.0 / solid_angle);
  }
  if (near || !quad) return in_range(density_of_area(dir_world, distance));
  const V3d offset = dir * reach - seen.to_p0;
  const V2d shares(std::clamp(offset.dot(dual1), 0.0, 1.0), std::clamp(offset.dot(dual2), 0.0, 1.0));
  return in_range(received(at, seen).density(shares) * density_of_area(dir_world, distance));
}

std::optional<LightSample> AreaLight::sample(const Receiver& at, const V2f& u) const {
  const View seen = view(at);
  if (!(seen.height > 0.0)) return std::nullopt;
  const V3d e1(edge1), e2(edge2);
  V2d shares = quad ? V2d(u) : square_to_triangle(u);  // of the edges
  double density = 0.0;                                // per solid angle; 0: by area
  double share_density = 1.0;
  const bool near = is_near(seen);
  if (near && right_angled) {
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
  } else if (near && !quad) {
    const SphericalTriangle map = seen_triangle(seen);
    if (map.solid_angle() > kLeastSolidAngle) {
      density = 1.0 / map.solid_angle();
      // Where the direction meets the plane.
      const V3d dir = map.sample(u);
      const double scale = 1.0 / dir.dot(e1.cross(e2));
      shares.x = std::clamp(-dir.dot(seen.to_p0.cross(e2)) * scale, 0.0, 1.0);
      shares.y = std::clamp(dir.dot(seen.to_p0.cross(e1)) * scale, 0.0, 1.0 - shares.x);
    }
  } else if (!near && quad) {
    const BilinearWarp warp = received(at, seen);
    shares = warp.sample(u);
    share_density = warp.density(shares);
  }
  const V3d to_light = seen.to_p0 + e1 * shares.x + e2 * shares.y;
  const double distance = std::sqrt(to_light.dot(to_light));
  if (!(distance > 0.0)) return std::nullopt;
  const V3f dir_world(to_light * (1.0 / distance));
  if (density == 0.0) density = share_density * density_of_area(dir_world, static_cast<float>(distance));
  const float pdf = in_range(density);
  if (!(pdf > 0.0f)) return std::nullopt;
  return LightSample{dir_world, static_cast<float>(distance), radiance, pdf, group, false, extent};
}

}  // namespace becalm::tracer
