#include "tracer/scene/relief.h"

#include <cmath>

namespace becalm::tracer {

namespace {

/// Cosine to the geometric normal that a normal beyond the horizon is brought back to, as in visible_normal
/// (shading_vertex.h).
constexpr float kLeastCos = 0.01f;

/// Parameter directions whose angle is smaller than this span no surface.
constexpr double kLeastSine = 1e-6;

/// The tangents along u and v, perpendicular to the normal, in double: lengths of 1e30 must have products.
struct Tangents {
  V3d along_u, along_v;
  V3d normal;
  double area;  ///< signed by whether (along_u, along_v, normal) is right-handed; 0: they span no surface
};

Tangents tangents(const ReliefPoint& point, const V3f& normal) {
  Tangents t;
  t.normal = V3d(normal);
  const V3d u(point.dpdu), v(point.dpdv);
  t.along_u = u - t.normal * t.normal.dot(u);
  t.along_v = v - t.normal * t.normal.dot(v);
  t.area = t.along_u.cross(t.along_v).dot(t.normal);
  const double longest = std::sqrt(t.along_u.dot(t.along_u)) * std::sqrt(t.along_v.dot(t.along_v));
  if (!(std::abs(t.area) > kLeastSine * longest) || !std::isfinite(t.area)) t.area = 0.0;
  return t;
}

V3f to_hemisphere(const V3d& direction, const V3f& geometric, const V3f& otherwise) {
  const double length = std::sqrt(direction.dot(direction));
  if (!(length > 0.0) || !std::isfinite(length)) return otherwise;
  const V3f unit(direction / length);
  const float cosine = unit.dot(geometric);
  if (cosine > 0.0f) return unit;
  return (unit + geometric * (kLeastCos - cosine)).normalized();
}

V3f mapped_normal(const NormalMap& map, const Textures::Reader& textures, const ReliefPoint& point,
                  const V3f& normal) {
  const Tangents t = tangents(point, normal);
  if (t.area == 0.0) return normal;
  const V3d n = V3d(textures.data(map.texture, point.texture)) * 2.0 - V3d(1.0);
  const V3d tangent = t.along_u.normalized();
  const V3d bitangent = t.normal.cross(tangent) * std::copysign(1.0, t.area);
  return to_hemisphere((tangent * n.x + bitangent * n.y) * map.strength + t.normal * n.z,
                       point.normal_geometric, normal);
}

V3f bumped_normal(const BumpMap& map, const Textures::Reader& textures, const ReliefPoint& point,
                  const V3f& normal) {
  const Tangents t = tangents(point, normal);
  if (t.area == 0.0) return normal;
  const TexturePoint& at = point.texture;
  const V2f texel = textures.texel(map.texture);
  // Half the steps' length: the footprint's extent along u and v, at most the whole picture.
  const auto half_step = [](float dx, float dy, float texel_size) {
    return std::clamp(0.5f * (std::abs(dx) + std::abs(dy)), 0.5f * texel_size, 0.5f);
  };
  const float du = half_step(at.duv_dx.x, at.duv_dy.x, std::min(texel.x, 1.0f));
  const float dv = half_step(at.duv_dx.y, at.duv_dy.y, std::min(texel.y, 1.0f));
  const auto height = [&](float u, float v) -> double {
    return textures.scalar(map.texture, {at.uv + V2f(u, v), at.duv_dx, at.duv_dy});
  };
  const double slope_u = map.scale * (height(du, 0.0f) - height(-du, 0.0f)) / (2.0 * du);
  const double slope_v = map.scale * (height(0.0f, dv) - height(0.0f, -dv)) / (2.0 * dv);
  const V3d gradient = (t.along_v.cross(t.normal) * slope_u + t.normal.cross(t.along_u) * slope_v) / t.area;
  return to_hemisphere(t.normal - gradient, point.normal_geometric, normal);
}

}  // namespace

V3f perturbed_normal(const Material& material, const Textures::Reader& textures, const ReliefPoint& point) {
  V3f normal = point.normal_shading;
  if (material.normal_map) normal = mapped_normal(*material.normal_map, textures, point, normal);
  if (material.bump) normal = bumped_normal(*material.bump, textures, point, normal);
  return normal;
}

}  // namespace becalm::tracer
