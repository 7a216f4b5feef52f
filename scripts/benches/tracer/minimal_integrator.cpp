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

}  // namespace

PathSample minimal_path(const PathContext& context, const V2f& raster, Sampler& sampler) {
  const Snapshot& snapshot = context.snapshot;
  const Lights& lights = snapshot.lights();
  const Integrator& integrator = context.integrator;
  PathSample result;
  Ray ray = context.cameras.current().ray(raster);
  V3f throughput(1.0f), previous_position(0.0f);
  Lights::Received previous;
  float pdf = 0.0f;
  for (int depth = 0;; ++depth) {
    const std::optional<Hit> hit = snapshot.intersector().closest(ray);
    if (!hit) {
      if (depth == 0) result.covered = snapshot.description().environment.has_value();
      lights.for_each_infinite(ray.dir, [&](const V3f& radiance, std::uint16_t, const auto& light_pdf) {
        result.radiance +=
            throughput * radiance * (pdf == 0.0f ? 1.0f : power_heuristic(pdf, light_pdf(previous)));
      });
      return result;
    }
    result.covered = true;
    const ObjectState& object = snapshot.object(hit->object);
    const Surface surface = surface_at(object, object.place, *hit);
    const V3f wo = -ray.dir;
    if (object.first_light != kNoLight && (object.two_sided || wo.dot(surface.normal_geometric) > 0.0f)) {
      float weight = 1.0f;
      if (pdf != 0.0f) {
        weight = power_heuristic(
            pdf, lights.pdf_triangle(object.first_light + std::size_t{hit->triangle}, previous, ray.dir,
                                     (surface.position - previous_position).length()));
      }
      result.radiance += throughput * object.emission * weight;
    }
    if (depth == integrator.max_depth) return result;

    const float u_light = sampler.next_1d();
    const V2f u_point = sampler.next_2d(), u_material = sampler.next_2d();
    sampler.next_1d();  // the tracer chooses a lobe with it
    const float u_roulette = sampler.next_1d();
    const V3f reflectance = std::get<DiffuseBsdf>(object.material->bsdf).reflectance;
    const ShadingFrame frame = ShadingFrame::from_normal(visible(surface, wo));
    const float wo_z = wo.dot(frame.normal), wo_g = wo.dot(surface.normal_geometric);

    const Receiver receiver(surface.position, wo_z < 0.0f ? -frame.normal : frame.normal);
    previous = lights.received(receiver, 0.0f);
    if (const auto light = lights.sample(previous, u_light, u_point)) {
      const float cos_i = light->dir_world.dot(frame.normal);
      if (light->dir_world.dot(surface.normal_geometric) * wo_g * (cos_i * wo_z) > 0.0f &&
          cos_i * wo_z > 0.0f) {
        const float bsdf_pdf = std::abs(cos_i) * std::numbers::inv_pi_v<float>;
        V3f direct = reflectance * bsdf_pdf * light->radiance / light->pdf_solid_angle;
        if (!light->delta) direct *= power_heuristic(light->pdf_solid_angle, bsdf_pdf);
        Ray shadow{offset_origin(surface, light->dir_world), light->dir_world};
        if (light->distance < kInfinity) {
          shadow.dir = surface.position + light->dir_world * light->distance - shadow.origin;
          shadow.t_max =
              1.0f - 1e-4f -
              std::max(light->extent, largest_coordinate(shadow.origin)) * 0x1p-18f / light->distance;
        }
        if (!is_black(direct) && !(shadow.t_max > 0.0f && snapshot.intersector().occluded(shadow)))
          result.radiance += throughput * direct;
      }
    }

    const float radius = std::sqrt(u_material.x), phi = 2.0f * std::numbers::pi_v<float> * u_material.y;
    const float cos_i = std::sqrt(std::max(0.0f, 1.0f - u_material.x));
    if (cos_i == 0.0f || wo_z == 0.0f) return result;
    const V3f wi =
        frame.to_world({radius * std::cos(phi), radius * std::sin(phi), std::copysign(cos_i, wo_z)})
            .normalized();
    if (!(wi.dot(surface.normal_geometric) * wo_g > 0.0f)) return result;
    throughput *= reflectance;
    if (is_black(throughput)) return result;
    pdf = cos_i * std::numbers::inv_pi_v<float>;
    previous_position = surface.position;
    if (depth + 1 >= integrator.roulette_depth) {
      const float survival = std::min(1.0f, max_component(throughput));
      if (u_roulette >= survival) return result;
      throughput /= survival;
    }
    ray = {offset_origin(surface, wi), wi};
  }
}

}  // namespace becalm::bench
