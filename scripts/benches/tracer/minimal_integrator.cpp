#include "scripts/benches/tracer/minimal_integrator.h"

#include <limits>
#include <numbers>

#include "tracer/math/shading_frame.h"
#include "tracer/snapshot/surface.h"

namespace becalm::bench {

using namespace becalm::tracer;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float power_heuristic(float pdf, float other) {
  const float ratio = other / pdf;
  return 1.0f / (1.0f + ratio * ratio);
}

V3f visible(const Surface& surface, const V3f& wo) {
  const float side = wo.dot(surface.normal_geometric) < 0.0f ? -1.0f : 1.0f;
  const float cos_wo = side * surface.normal_shading.dot(wo);
  if (cos_wo >= 0.01f || side * wo.dot(surface.normal_geometric) < 0.01f)
    return cos_wo > 0.0f ? surface.normal_shading : surface.normal_geometric;
  return (surface.normal_shading + wo * (side * (0.01f - cos_wo))).normalized();
}

/// What the path's last scattering leaves behind.
struct Arrival {
  Ray ray;
  V3f throughput{1.0f};
  float pdf = 0.0f;  // of the ray's direction; 0 for the eye's
  V3f position{0.0f};
  Lights::Received received{};  // what lights send there
};

V3f escaped_light(const Lights& lights, const Arrival& from) {
  V3f sum(0.0f);
  lights.for_each_infinite(from.ray.dir, [&](const V3f& radiance, std::uint16_t, const auto& light_pdf) {
    const float weight = from.pdf == 0.0f ? 1.0f : power_heuristic(from.pdf, light_pdf(from.received));
    sum += from.throughput * radiance * weight;
  });
  return sum;
}

V3f emitted_light(const Lights& lights, const Arrival& from, const ObjectState& object,
                  std::uint32_t triangle, const Surface& surface) {
  const bool shines = object.two_sided || from.ray.dir.dot(surface.normal_geometric) < 0.0f;
  if (object.first_light == kNoLight || !shines) return V3f(0.0f);
  float weight = 1.0f;
  if (from.pdf != 0.0f) {
    const float distance = (surface.position - from.position).length();
    weight = power_heuristic(from.pdf, lights.pdf_triangle(object.first_light + std::size_t{triangle},
                                                           from.received, from.ray.dir, distance));
  }
  return from.throughput * object.emission * weight;
}

/// A point of a diffuse surface, seen along -wo.
struct Vertex {
  const Surface& surface;
  V3f reflectance;
  ShadingFrame frame;
  float wo_z;  // cosines of wo with the shading and the geometric normal
  float wo_g;
};

Ray shadow_ray(const Surface& surface, const LightSample& light) {
  Ray shadow{offset_origin(surface, light.dir_world), light.dir_world};
  if (light.distance < kInfinity) {
    shadow.dir = surface.position + light.dir_world * light.distance - shadow.origin;
    shadow.t_max =
        1.0f - 1e-4f - std::max(light.extent, largest_coordinate(shadow.origin)) * 0x1p-18f / light.distance;
  }
  return shadow;
}

/// The light sample's part of the direct light that leaves the vertex.
V3f direct_light(const Snapshot& snapshot, const Vertex& at, const Lights::Received& received, float u_light,
                 const V2f& u_point) {
  const auto light = snapshot.lights().sample(received, u_light, u_point);
  if (!light) return V3f(0.0f);
  const float cos_i = light->dir_world.dot(at.frame.normal);
  if (!(light->dir_world.dot(at.surface.normal_geometric) * at.wo_g * (cos_i * at.wo_z) > 0.0f &&
        cos_i * at.wo_z > 0.0f)) {
    return V3f(0.0f);
  }
  const float bsdf_pdf = std::abs(cos_i) * std::numbers::inv_pi_v<float>;
  V3f direct = at.reflectance * bsdf_pdf * light->radiance / light->pdf_solid_angle;
  if (!light->delta) direct *= power_heuristic(light->pdf_solid_angle, bsdf_pdf);
  if (is_black(direct)) return direct;
  const Ray shadow = shadow_ray(at.surface, *light);
  return shadow.t_max > 0.0f && snapshot.intersector().occluded(shadow) ? V3f(0.0f) : direct;
}

/// The next direction by the cosine; false if the path ends.
bool scatter(const Vertex& at, const V2f& u, Arrival& path) {
  const float radius = std::sqrt(u.x), phi = 2.0f * std::numbers::pi_v<float> * u.y;
  const float cos_i = std::sqrt(std::max(0.0f, 1.0f - u.x));
  if (cos_i == 0.0f || at.wo_z == 0.0f) return false;
  const V3f wi =
      at.frame.to_world({radius * std::cos(phi), radius * std::sin(phi), std::copysign(cos_i, at.wo_z)})
          .normalized();
  if (!(wi.dot(at.surface.normal_geometric) * at.wo_g > 0.0f)) return false;
  path.throughput *= at.reflectance;
  if (is_black(path.throughput)) return false;
  path.pdf = cos_i * std::numbers::inv_pi_v<float>;
  path.position = at.surface.position;
  path.ray = {offset_origin(at.surface, wi), wi};
  return true;
}

bool survives_roulette(float u, Arrival& path) {
  const float survival = std::min(1.0f, max_component(path.throughput));
  if (u >= survival) return false;
  path.throughput /= survival;
  return true;
}

}  // namespace

PathSample minimal_path(const PathContext& context, const V2f& raster, Sampler& sampler) {
  const Snapshot& snapshot = context.snapshot;
  const Lights& lights = snapshot.lights();
  PathSample result;
  Arrival path{.ray = context.cameras.current().ray(raster)};
  for (int depth = 0;; ++depth) {
    const std::optional<Hit> hit = snapshot.intersector().closest(path.ray);
    if (!hit) {
      if (depth == 0) result.covered = snapshot.description().environment.has_value();
      result.radiance += escaped_light(lights, path);
      return result;
    }
    result.covered = true;
    const ObjectState& object = snapshot.object(hit->object);
    const Surface surface = surface_at(object, object.place, *hit);
    result.radiance += emitted_light(lights, path, object, hit->triangle, surface);
    if (depth == context.integrator.max_depth) return result;

    const float u_light = sampler.next_1d();
    const V2f u_point = sampler.next_2d(), u_material = sampler.next_2d();
    sampler.next_1d();  // the tracer chooses a lobe with it
    const float u_roulette = sampler.next_1d();
    const V3f wo = -path.ray.dir;
    const ShadingFrame frame = ShadingFrame::from_normal(visible(surface, wo));
    const Vertex at{surface, std::get<DiffuseBsdf>(object.material->bsdf).reflectance, frame,
                    wo.dot(frame.normal), wo.dot(surface.normal_geometric)};
    const Receiver receiver(surface.position, at.wo_z < 0.0f ? -frame.normal : frame.normal);
    path.received = lights.received(receiver, 0.0f);
    result.radiance += path.throughput * direct_light(snapshot, at, path.received, u_light, u_point);
    if (!scatter(at, u_material, path)) return result;
    if (depth + 1 >= context.integrator.roulette_depth && !survives_roulette(u_roulette, path)) return result;
  }
}

}  // namespace becalm::bench
