#include "tracer/path_trace.h"

#include <array>
#include <cassert>
#include <utility>

#include "tracer/materials/shading_frame.h"
#include "tracer/surface.h"

// The estimator
//
// Let x_0 be the eye, x_1, x_2, ... the vertices of a path, and L(x_k) the radiance that leaves x_k towards
// x_{k-1}. Then
//
//   L(x_k) = Le(x_k) + int f_k(wi) |cos wi| L(x_{k+1}(wi)) dwi                                      over the
//   unit sphere
//
// with x_{k+1}(wi) the first surface in direction wi, or the environment. The indirect part of the integral
// is estimated by one direction wi from the material's density p_m (per solid angle): the throughput T_{k+1}
// = T_k f_k |cos| / p_m carries on to x_{k+1}. The direct part, with Le(x_{k+1}) in place of L, is estimated
// twice, by that same direction and by one from the lights' density p_l (also per solid angle, including the
// choice of the light), and the two are combined with weights that add up to 1 wherever both may be drawn
// (Veach and Guibas 1995):
//
//   T_k f_k(w_l) |cos w_l| V(w_l) Le / p_l(w_l) * w_light(w_l)     +     T_{k+1} Le(x_{k+1}) *
//   w_material(w_m)
//
//   w_light = h(p_l, p_m),  w_material = h(p_m, p_l),  h(a, b) = a^n / (a^n + b^n),  n = 2: power, 1:
//   balance.
//
// A delta lobe has no density that lights could be drawn against: after it, and at x_1, where no light was
// drawn, Le counts whole. `direct: light` and `direct: material` set one weight to 1 and the other to 0, so
// that the three must agree in expectation, which tests hold. The path ends after max_depth scattering
// events; from roulette_depth on it survives with probability q = min(0.95, max T), after which T is divided
// by q, which keeps the expectation. Radiance grows and shrinks by the squared index of refraction while
// inside glass; q leaves that factor out.

namespace becalm::tracer {

namespace {

/// What a variant of the integrator can do; false removes the code.
struct Features {
  bool specular;  ///< materials of delta lobes alone
  bool textures;
  bool guides;
};

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Rays that left a rough surface see textures blurred by this angle in radians: about the spacing of the few
/// directions that a pixel sends into the hemisphere.
constexpr float kScatteredSpread = 0.1f;

/// Width in pixels over which textures are averaged. The pixel filter averages the rest, so half a pixel
/// neither blurs nor aliases, and it does not depend on the sample count, so that more samples converge to
/// the same image.
constexpr float kTextureFootprintPx = 0.5f;

/// Shadow rays end short of the light by this share of the way (and by rounding errors), so as not to hit it.
constexpr float kShadowShortening = 1e-4f;

float mis_weight(Heuristic heuristic, float pdf, float other_pdf) {
  assert(pdf > 0.0f);
  const float ratio = other_pdf / pdf;  // in this form nothing overflows to NaN
  return 1.0f / (1.0f + (heuristic == Heuristic::power ? ratio * ratio : ratio));
}

/// The shading normal, turned as far towards `wo` as needed for both normals to see `wo` on the same side.
/// Near the silhouettes of smooth meshes the interpolated normal may face away.
V3f visible_normal(const Surface& surface, const V3f& wo) {
  const V3f& ns = surface.normal_shading;
  const float side = wo.dot(surface.normal_geometric) < 0.0f ? -1.0f : 1.0f;
  constexpr float least_cos = 0.01f;
  const float cos_wo = side * ns.dot(wo);
  if (cos_wo >= least_cos || side * wo.dot(surface.normal_geometric) < least_cos)
    return cos_wo > 0.0f ? ns : surface.normal_geometric;
  return (ns + wo * (side * (least_cos - cos_wo))).normalized();
}

/// Radiance that the hit surface emits along the ray backward.
V3f emitted(const ObjectState& object, const Surface& surface, const V3f& ray_dir) {
  if (object.first_light == kNoLight) return V3f(0.0f);
  return object.two_sided || ray_dir.dot(surface.normal_geometric) < 0.0f ? object.emission : V3f(0.0f);
}

/// Of a point that appears there now and appeared there in the previous frame. What was behind the previous
/// camera has no place to come from and counts as unmoved.
V2f motion(const std::optional<V2d>& current, const std::optional<V2d>& previous) {
  return current && previous ? V2f(*previous - *current) : V2f(0.0f);
}

template <Features F>
Bsdf bsdf_at(const PathContext& context, const Material& material, const Surface& surface, float cone_width) {
  if constexpr (F.textures) {
    const float width = cone_width * surface.uv_per_length;
    return evaluate_material(material, context.textures, {surface.uv, {width, 0.0f}, {0.0f, width}});
  }
  return material.bsdf;
}

V3f clamp_to_unit(const V3f& v) {
  return {std::clamp(v.x, 0.0f, 1.0f), std::clamp(v.y, 0.0f, 1.0f), std::clamp(v.z, 0.0f, 1.0f)};
}

/// The vertex that a path scatters at.
struct Vertex {
  const Surface& surface;
  const Bsdf& bsdf;
  ShadingFrame frame;
  V3f wo_world;
  V3f wo;  ///< local

  /// Whether the shading and the geometric normal agree on the side of wi; light that would leak through is
  /// dropped.
  bool consistent(const V3f& wi, const V3f& wi_world) const {
    const float geometric = wi_world.dot(surface.normal_geometric) * wo_world.dot(surface.normal_geometric);
    return geometric * (wi.z * wo.z) > 0.0f;
  }
};

/// The light sample's part of the direct light, without the throughput.
V3f direct_light(const PathContext& context, const Vertex& vertex, float u_light, const V2f& u) {
  const Snapshot& snapshot = context.snapshot;
  const std::optional<LightSample> light = snapshot.lights().sample(vertex.surface.position, u_light, u);
  if (!light) return V3f(0.0f);
  const V3f wi = vertex.frame.to_local(light->dir_world);
  if (!vertex.consistent(wi, light->dir_world)) return V3f(0.0f);
  V3f contribution = eval(vertex.bsdf, vertex.wo, wi) * light->radiance / light->pdf_solid_angle;
  if (is_black(contribution)) return V3f(0.0f);
  if (context.integrator.direct == Direct::mis) {
    contribution *= mis_weight(context.integrator.heuristic, light->pdf_solid_angle,
                               pdf_solid_angle(vertex.bsdf, vertex.wo, wi));
  }
  Ray shadow{offset_origin(vertex.surface, light->dir_world), light->dir_world};
  if (light->distance < kInfinity) {
    shadow.dir = vertex.surface.position + light->dir_world * light->distance - shadow.origin;
    shadow.t_max = 1.0f - kShadowShortening - snapshot.extent() * 0x1p-18f / light->distance;
    if (shadow.t_max <= 0.0f) return contribution;
  }
  return snapshot.intersector().occluded(shadow) ? V3f(0.0f) : contribution;
}

template <Features F>
PathSample trace_path(const PathContext& context, const V2f& raster, Sampler& sampler) {
  const Snapshot& snapshot = context.snapshot;
  const Integrator& integrator = context.integrator;
  const bool draw_lights = integrator.direct != Direct::material && !snapshot.lights().empty();

  PathSample result;
  Ray ray = context.camera.ray(raster);
  V3f throughput(1.0f);
  float radiance_scale = 1.0f;  // squared index of refraction contained in the throughput
  float cone_width = 0.0f;      // diameter of the ray cone at the ray's origin
  float cone_spread = kTextureFootprintPx * static_cast<float>(context.camera.pixel_angle());
  V3f previous_position;      // of the vertex that the ray left, without the offset
  float material_pdf = 0.0f;  // of the ray's direction; 0 where light sampling had no chance
  bool specular_so_far = true;

  // Weight of light that the ray ran into by itself, when light sampling finds it with that density.
  const auto weight = [&](const auto& light_pdf) {
    if (material_pdf == 0.0f || integrator.direct == Direct::material) return 1.0f;
    return integrator.direct == Direct::light ? 0.0f
                                              : mis_weight(integrator.heuristic, material_pdf, light_pdf());
  };

  for (int depth = 0;; ++depth) {
    const std::optional<Hit> hit = snapshot.intersector().closest(ray);
    if (!hit) {
      if (depth == 0) result.covered = snapshot.description().environment.has_value();
      const V3f radiance = snapshot.lights().environment_radiance(ray.dir);
      if (!is_black(radiance)) {
        result.radiance +=
            throughput * radiance * weight([&] { return snapshot.lights().pdf_environment(ray.dir); });
      }
      if constexpr (F.guides) {
        if (specular_so_far) result.guides.albedo = clamp_to_unit(throughput / radiance_scale);
        if (depth == 0) {
          result.guides.motion = motion(context.camera.project_direction(V3d(ray.dir)),
                                        context.previous_camera.project_direction(V3d(ray.dir)));
        }
      }
      break;
    }

    const ObjectState& object = snapshot.object(hit->object);
    const Surface surface = surface_at(object, *hit);
    cone_width += cone_spread * hit->t;
    if (depth == 0) {
      result.covered = true;
      if constexpr (F.guides) {
        const PointMotion point = point_motion(object, *hit);
        result.guides.depth = hit->t;
        result.guides.motion =
            motion(context.camera.project(point.current), context.previous_camera.project(point.previous));
      }
    }

    const V3f radiance = emitted(object, surface, ray.dir);
    if (!is_black(radiance)) {
      result.radiance +=
          throughput * radiance * weight([&] {
            const std::size_t triangle = object.first_light + std::size_t{hit->triangle};
            const float distance = (surface.position - previous_position).length();
            return snapshot.lights().pdf_triangle(triangle, previous_position, ray.dir, distance);
          });
    }
    if (context.log != nullptr) {
      context.log->push_back({hit->object, surface.position, throughput, result.radiance});
    }

    const bool wants_guides = F.guides && specular_so_far;
    if (depth == integrator.max_depth && !wants_guides) break;
    const Bsdf bsdf = bsdf_at<F>(context, *object.material, surface, cone_width);
    const V3f wo_world = -ray.dir;
    const V3f normal = visible_normal(surface, wo_world);
    const bool specular = F.specular && is_specular(bsdf);
    if (wants_guides && (!specular || depth == integrator.max_depth)) {
      result.guides.albedo = clamp_to_unit(throughput / radiance_scale * albedo(bsdf));
      result.guides.normal = normal.dot(wo_world) < 0.0f ? -normal : normal;
    } else if (wants_guides) {
      result.guides.albedo = V3f(0.0f);  // stays if the path ends inside the mirror or glass
    }
    if (depth == integrator.max_depth) break;

    // Every event draws the same dimensions, used or not, so that those of later events stay stratified among
    // samples.
    const float u_light = sampler.next_1d();
    const V2f u_light_point = sampler.next_2d();
    const V2f u_material = sampler.next_2d();
    const float u_lobe = sampler.next_1d();
    const float u_roulette = sampler.next_1d();

    const ShadingFrame frame = ShadingFrame::from_normal(normal);
    const Vertex vertex{surface, bsdf, frame, wo_world, frame.to_local(wo_world)};
    if (draw_lights && !specular) {
      result.radiance += throughput * direct_light(context, vertex, u_light, u_light_point);
    }

    const std::optional<BsdfSample> scattered = sample(bsdf, vertex.wo, u_material, u_lobe);
    if (!scattered) break;
    const V3f wi_world = frame.to_world(scattered->wi).normalized();
    if (!vertex.consistent(scattered->wi, wi_world)) break;
    throughput *= scattered->weight;
    if (is_black(throughput)) break;
    radiance_scale *= scattered->radiance_scale;
    specular_so_far = specular_so_far && specular;
    material_pdf = scattered->specular ? 0.0f : scattered->pdf;
    if (!scattered->specular) cone_spread = std::max(cone_spread, kScatteredSpread);
    previous_position = surface.position;

    // A path that may still meet the surface of albedo and normal must get there.
    if (depth + 1 >= integrator.roulette_depth && !specular_so_far) {
      const float survival = std::min(0.95f, max_component(throughput) / radiance_scale);
      if (u_roulette >= survival) break;
      throughput /= survival;
    }
    ray = {offset_origin(surface, wi_world), wi_world};
  }
  return result;
}

template <std::size_t... I>
constexpr std::array<PathFunction, sizeof...(I)> make_variants(std::index_sequence<I...>) {
  return {&trace_path<Features{(I & 1) != 0, (I & 2) != 0, (I & 4) != 0}>...};
}

}  // namespace

PathFunction select_path_function(const SceneNeeds& needs, bool with_guides) {
  static constexpr auto variants = make_variants(std::make_index_sequence<8>());
  return variants[(needs.specular ? 1 : 0) | (needs.textures ? 2 : 0) | (with_guides ? 4 : 0)];
}

}  // namespace becalm::tracer
