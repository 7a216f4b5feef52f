#include "tracer/path_trace.h"

#include <array>
#include <cassert>

#include "tracer/mis.h"
#include "tracer/ray_differential.h"
#include "tracer/scene/relief.h"
#include "tracer/shading_vertex.h"

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
  bool surfaces;  ///< materials other than plain diffuse ones
  bool textures;  ///< what varies over a surface, and the ray differentials that say how far to average it
  bool media;     ///< scattering inside objects, and interfaces that only bound them
  bool blur;      ///< the shutter is open for a time, or the lens has a width
  bool guides;
};

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Rays that left a rough surface see textures blurred by this angle in radians: about the spacing of the few
/// directions that a pixel sends into the hemisphere.
constexpr float kScatteredSpread = 0.1f;

/// Shadow rays end short of the light by this share of the way (and by rounding errors), so as not to hit it.
constexpr float kShadowShortening = 1e-4f;

/// Interfaces that a path crosses at most: rounding may find one again and again.
constexpr int kMostCrossings = 1000;

/// Between the seeds of a path's rays.
constexpr std::uint32_t kRaySeedStep = 0x9e3779b9u;

/// Radiance that the hit surface emits along the ray backward.
V3f emitted(const ObjectState& object, const Surface& surface, const V3f& ray_dir) {
  if (is_black(object.emission)) return V3f(0.0f);
  return object.two_sided || ray_dir.dot(surface.normal_geometric) < 0.0f ? object.emission : V3f(0.0f);
}

/// Of a point that appears there now and appeared there in the previous frame. What was behind the previous
/// camera has no place to come from and counts as unmoved.
V2f motion(const std::optional<V2d>& current, const std::optional<V2d>& previous) {
  return current && previous ? V2f(*previous - *current) : V2f(0.0f);
}

V3f clamp_to_unit(const V3f& v) {
  return {std::clamp(v.x, 0.0f, 1.0f), std::clamp(v.y, 0.0f, 1.0f), std::clamp(v.z, 0.0f, 1.0f)};
}

/// One path from the eye on, and what it has gathered so far.
template <Features F>
class Path {
 public:
  Path(const PathContext& context, const V2f& raster, Sampler& sampler)
      : context_(context),
        snapshot_(context.snapshot),
        integrator_(context.integrator),
        sampler_(sampler),
        draws_lights_(integrator_.direct != Direct::material && !snapshot_.lights().empty()) {
    if constexpr (F.blur) {
      // Drawn whichever of them the scene has, so that the dimensions of what follows do not depend on it.
      time_ = sampler.next_1d();
      const V2f u_lens = sampler.next_2d();
      start(context.cameras.moves() ? context.cameras.current(time_) : context.cameras.current(), raster,
            u_lens);
      ray_.time = time_;
    } else {
      start(context.cameras.current(), raster, std::nullopt);
    }
    if constexpr (F.surfaces) ray_.seed = sampler.seed_of_rays();
    if constexpr (F.media) interiors_ = context.eye_interiors;
  }

  PathSample trace() {
    while (step()) {
    }
    return result_;
  }

 private:
  void start(const Camera& camera, const V2f& raster, const std::optional<V2f>& u_lens) {
    ray_ = u_lens ? camera.ray(raster, *u_lens) : camera.ray(raster);
    if constexpr (F.textures) {
      // Those of the pinhole: what the lens adds, its samples average.
      const V3f dir(camera.direction(raster));
      const RayDifferential pixel{.dpdx = V3f(0.0f),
                                  .dpdy = V3f(0.0f),
                                  .dddx = unit_derivative(dir, V3f(camera.right())),
                                  .dddy = unit_derivative(dir, V3f(camera.down()))};
      differential_ = pixel * context_.footprint_scale;
    }
  }

  /// Follows the ray to what it meets and scatters there; false when the path ends.
  bool step();
  void escape();
  void see_primary(std::uint32_t object, float distance, const PointMotion& point);
  bool cross_interface(const ObjectState& object, const Hit& hit, const Surface& surface);
  bool scatter_in_medium(const Medium& medium, float t);
  void gather_direct_light_in_medium(const V3f& position, float g, float u_light, const V2f& u);
  void gather_emission(const ObjectState& object, const Hit& hit, const Surface& surface);
  bool scatter(const ObjectState& object, const Hit& hit, Surface& surface);
  Bsdf shade(const ObjectState& object, const Hit& hit, Surface& surface, float u_mix, V3f& tangent);
  void bend_differential(const ObjectState& object, const Hit& hit, const V3f& normal,
                         const BsdfSample& scattered, const V3f& wi_world);
  V3f transmission(Ray shadow);
  V3f visibility(const V3f& from, const V3f& position, const LightSample& light);
  bool survives_roulette(float u);
  void gather_direct_light(const ShadingVertex& vertex, float u_light, const V2f& u);

  /// Each ray decides anew what it passes through.
  void next_ray_seed() { ray_.seed += kRaySeedStep; }

  std::optional<Hit> closest(const Ray& ray) const {
    if (context_.rays != nullptr) context_.rays->push_back({ray, false});
    return snapshot_.intersector().closest(ray);
  }
  bool occluded(const Ray& ray) const {
    if (context_.rays != nullptr) context_.rays->push_back({ray, true});
    return snapshot_.intersector().occluded(ray);
  }

  Place place_of(const ObjectState& object) const {
    return F.blur && object.blurred() ? object.at(time_) : object.place;
  }
  Surface surface_of(const ObjectState& object, const Hit& hit, float footprint) const {
    if (F.blur && object.blurred()) return surface_at(object, object.at(time_), hit, footprint);
    return surface_at(object, object.place, hit, footprint);
  }
  /// Width of the ray's share of a pixel so far along it.
  float footprint_at(float t) const {
    return F.textures ? std::max((differential_.dpdx + differential_.dddx * t).length(),
                                 (differential_.dpdy + differential_.dddy * t).length())
                      : 0.0f;
  }

  /// Radiance that reached the eye after so many scatterings other than at perfect mirrors and glass.
  void gather(const V3f& radiance, int scatterings, std::uint16_t group) {
    result_.radiance += radiance;
    if (context_.split != nullptr) context_.split->add(radiance, scatterings, group);
  }

  /// Weight of light that the ray ran into by itself, when light sampling finds it with that density.
  template <class LightPdf>
  float weight(const LightPdf& light_pdf) const {
    if (material_pdf_ == 0.0f || integrator_.direct == Direct::material) return 1.0f;
    const float pdf = light_pdf();
    if (integrator_.direct == Direct::light) return pdf > 0.0f ? 0.0f : 1.0f;
    return mis_weight(integrator_.heuristic, material_pdf_, pdf);
  }

  const PathContext& context_;
  const Snapshot& snapshot_;
  const Integrator& integrator_;
  Sampler& sampler_;
  const bool draws_lights_;

  PathSample result_;
  Ray ray_;
  float time_ = 0.0f;
  V3f throughput_{1.0f};
  float radiance_scale_ = 1.0f;   // squared index of refraction contained in the throughput
  RayDifferential differential_;  // only with textures
  V3f previous_position_;         // of the vertex that the ray left, without the offset
  float material_pdf_ = 0.0f;     // of the ray's direction; 0 where light sampling had no chance
  Interiors interiors_;           // what the ray's origin lies in; only with media
  float travelled_ = 0.0f;        // to the ray's origin from the last scattering, through interfaces
  int crossings_ = 0;             // of interfaces
  int depth_ = 0;                 // scattering events so far
  int scatterings_ = 0;           // those other than at perfect mirrors and glass
};

template <Features F>
bool Path<F>::step() {
  const std::optional<Hit> hit = closest(ray_);
  if constexpr (F.media) {
    MediumRandom random(sampler_.next_2d());
    if (!interiors_.empty()) {
      const Medium& medium = *snapshot_.object(interiors_.innermost()).interior;
      const MediumSample event =
          sample_distance(medium, ray_.origin, ray_.dir, hit ? hit->t : kInfinity, random, throughput_);
      throughput_ *= event.weight;
      if (is_black(throughput_)) return false;
      if (event.scattered) return scatter_in_medium(medium, event.t);
    }
  }
  if (!hit) {
    escape();
    return false;
  }
  const ObjectState& object = snapshot_.object(hit->object);
  Surface surface = surface_of(object, *hit, object.mesh == nullptr ? footprint_at(hit->t) : 0.0f);
  if constexpr (F.textures)
    differential_ = transferred(differential_, ray_.dir, hit->t, surface.normal_geometric);
  if (F.media && object.material->is_interface) return cross_interface(object, *hit, surface);
  if (depth_ == 0)
    see_primary(hit->object, hit->t, F.guides ? point_motion(object, *hit, time_) : PointMotion{});
  gather_emission(object, *hit, surface);
  if (context_.log != nullptr) {
    context_.log->push_back({hit->object, surface.position, throughput_, result_.radiance});
  }
  return scatter(object, *hit, surface);
}

template <Features F>
bool Path<F>::cross_interface(const ObjectState& object, const Hit& hit, const Surface& surface) {
  if (++crossings_ > kMostCrossings) return false;
  cross_boundary(interiors_, object, hit.object, ray_.dir, surface);
  travelled_ += hit.t;
  ray_.origin = offset_origin(surface, ray_.dir);
  next_ray_seed();
  return true;
}

template <Features F>
void Path<F>::escape() {
  if (depth_ == 0) result_.covered = snapshot_.description().environment.has_value();
  snapshot_.lights().for_each_infinite(ray_.dir, [&](const V3f& radiance, float pdf, std::uint16_t group) {
    if (!is_black(radiance))
      gather(throughput_ * radiance * weight([&] { return pdf; }), scatterings_, group);
  });
  if constexpr (F.guides) {
    if (scatterings_ == 0) result_.guides.albedo = clamp_to_unit(throughput_ / radiance_scale_);
    if (depth_ == 0) {
      const V3d dir(ray_.dir);
      result_.guides.motion = motion(context_.cameras.current(time_).project_direction(dir),
                                     context_.cameras.previous(time_).project_direction(dir));
    }
  }
}

/// What the eye sees first, so far along the ray.
template <Features F>
void Path<F>::see_primary(std::uint32_t object, float distance, const PointMotion& point) {
  result_.covered = true;
  if constexpr (F.guides) {
    Guides& guides = result_.guides;
    guides.depth = travelled_ + distance;
    guides.motion = motion(context_.cameras.current(time_).project(point.current),
                           context_.cameras.previous(time_).project(point.previous));
    guides.ids = {object + 1, snapshot_.description().objects[object].material + 1};
  }
}

template <Features F>
void Path<F>::gather_emission(const ObjectState& object, const Hit& hit, const Surface& surface) {
  const V3f radiance = emitted(object, surface, ray_.dir);
  if (is_black(radiance)) return;
  const float mis = weight([&] {
    if (object.first_light == kNoLight) return 0.0f;
    if (object.mesh == nullptr)
      return snapshot_.lights().pdf_sphere(object.first_light, previous_position_, time_);
    const float distance = (surface.position - previous_position_).length();
    return snapshot_.lights().pdf_triangle(object.first_light + std::size_t{hit.triangle}, previous_position_,
                                           ray_.dir, distance, time_);
  });
  gather(throughput_ * radiance * mis, scatterings_, object.light_group);
}

/// The BSDF at the hit; the surface's normal becomes that of its relief.
template <Features F>
Bsdf Path<F>::shade(const ObjectState& object, const Hit& hit, Surface& surface, float u_mix, V3f& tangent) {
  if constexpr (F.textures) {
    if (object.material_varies) {
      const std::span<const Material> materials = snapshot_.description().materials;
      const SurfaceDifferentials around = differentials_at(object, place_of(object), hit);
      ParameterFootprint footprint;
      if (around.has_uvs)
        footprint = parameter_footprint(differential_.dpdx, differential_.dpdy, around.dpdu, around.dpdv);
      const TexturePoint point{surface.uv, footprint.duv_dx, footprint.duv_dy};
      const Material& material = resolve_mix(materials, *object.material, context_.textures, point, u_mix);
      if (has_relief(material)) {
        surface.normal_shading = perturbed_normal(
            material, context_.textures,
            {point, around.dpdu, around.dpdv, surface.normal_shading, surface.normal_geometric});
      }
      tangent = around.dpdu;
      return evaluate_material(material, context_.textures, point);
    }
  }
  return object.material->bsdf;
}

template <Features F>
bool Path<F>::scatter(const ObjectState& object, const Hit& hit, Surface& surface) {
  const bool wants_guides = F.guides && scatterings_ == 0;
  const bool last = depth_ == integrator_.max_depth;
  if (last && !wants_guides) return false;
  V3f tangent(0.0f);
  const float u_mix = F.textures && context_.mixes ? sampler_.next_1d() : 0.0f;
  Bsdf bsdf = shade(object, hit, surface, u_mix, tangent);
  if (F.textures && surface.slope_variance > 0.0f) widen(bsdf, surface.slope_variance);
  const V3f wo_world = -ray_.dir;
  const V3f normal = visible_normal(surface, wo_world);
  const bool specular = F.surfaces && is_specular(bsdf);
  if (wants_guides && (!specular || last)) {
    result_.guides.albedo = clamp_to_unit(throughput_ / radiance_scale_ * albedo(bsdf));
    result_.guides.normal = normal.dot(wo_world) < 0.0f ? -normal : normal;
  } else if (wants_guides) {
    result_.guides.albedo = V3f(0.0f);  // stays if the path ends inside the mirror or glass
  }
  if (last) return false;

  // Every event draws the same dimensions, used or not, so that those of later events stay stratified among
  // samples.
  const float u_light = sampler_.next_1d();
  const V2f u_light_point = sampler_.next_2d();
  const V2f u_material = sampler_.next_2d();
  const float u_lobe = sampler_.next_1d();
  const float u_roulette = sampler_.next_1d();

  const ShadingFrame frame = F.textures && object.material_varies
                                 ? ShadingFrame::from_normal_and_tangent(normal, tangent)
                                 : ShadingFrame::from_normal(normal);
  const ShadingVertex vertex(surface, bsdf, frame, wo_world);
  if (draws_lights_ && !specular) gather_direct_light(vertex, u_light, u_light_point);

  const std::optional<BsdfSample> scattered = sample(bsdf, vertex.wo, u_material, u_lobe);
  if (!scattered) return false;
  const V3f wi_world = frame.to_world(scattered->wi).normalized();
  if (!vertex.consistent(scattered->wi, wi_world)) return false;
  throughput_ *= scattered->weight;
  if (is_black(throughput_)) return false;
  radiance_scale_ *= scattered->radiance_scale;
  if (!specular) ++scatterings_;
  material_pdf_ = scattered->specular ? 0.0f : scattered->pdf;
  if constexpr (F.textures) bend_differential(object, hit, normal, *scattered, wi_world);
  previous_position_ = surface.position;

  if (F.media && scattered->transmitted) cross_boundary(interiors_, object, hit.object, wi_world, surface);
  ray_.origin = offset_origin(surface, wi_world);
  ray_.dir = wi_world;
  return survives_roulette(u_roulette);
}

/// Counts the scattering that has just happened and decides whether the path goes on after it.
template <Features F>
bool Path<F>::survives_roulette(float u) {
  ++depth_;
  travelled_ = 0.0f;
  next_ray_seed();
  // A path that may still meet the surface of albedo and normal must get there.
  if (depth_ < integrator_.roulette_depth || scatterings_ == 0) return true;
  const float survival = std::min(0.95f, max_component(throughput_) / radiance_scale_);
  if (u >= survival) return false;
  throughput_ /= survival;
  return true;
}

/// The differentials of the ray that leaves the hit.
template <Features F>
void Path<F>::bend_differential(const ObjectState& object, const Hit& hit, const V3f& normal,
                                const BsdfSample& scattered, const V3f& wi_world) {
  if (!scattered.specular) {
    differential_ = becalm::tracer::scattered(differential_, wi_world, kScatteredSpread);
    return;
  }
  const SurfaceDifferentials around = differentials_at(object, place_of(object), hit);
  const ParameterFootprint footprint =
      parameter_footprint(differential_.dpdx, differential_.dpdy, around.dpdu, around.dpdv);
  const V3f dndx = around.dndu * footprint.duv_dx.x + around.dndv * footprint.duv_dx.y;
  const V3f dndy = around.dndu * footprint.duv_dy.x + around.dndv * footprint.duv_dy.y;
  differential_ = scattered.transmitted ? refracted(differential_, ray_.dir, normal, dndx, dndy,
                                                    std::sqrt(scattered.radiance_scale))
                                        : reflected(differential_, ray_.dir, normal, dndx, dndy);
}

/// The light sample's part of the direct light.
template <Features F>
void Path<F>::gather_direct_light(const ShadingVertex& vertex, float u_light, const V2f& u) {
  const V3f& position = vertex.surface.position;
  const std::optional<LightSample> light = snapshot_.lights().sample(position, time_, u_light, u);
  if (!light) return;
  const V3f wi = vertex.frame.to_local(light->dir_world);
  if (!vertex.consistent(wi, light->dir_world)) return;
  V3f contribution = eval(vertex.bsdf, vertex.wo, wi) * light->radiance / light->pdf_solid_angle;
  if (is_black(contribution)) return;
  if (integrator_.direct == Direct::mis && !light->delta) {
    contribution *= mis_weight(integrator_.heuristic, light->pdf_solid_angle,
                               pdf_solid_angle(vertex.bsdf, vertex.wo, wi));
  }
  gather(throughput_ * contribution *
             visibility(offset_origin(vertex.surface, light->dir_world), position, *light),
         scatterings_ + 1, light->group);
}

/// Share of the light sample's radiance that arrives at `from`, which is `position` off its surface.
template <Features F>
V3f Path<F>::visibility(const V3f& from, const V3f& position, const LightSample& light) {
  next_ray_seed();
  Ray shadow = ray_;
  shadow.origin = from;
  shadow.dir = light.dir_world;
  shadow.t_max = kInfinity;
  if (light.distance < kInfinity) {
    shadow.dir = position + light.dir_world * light.distance - from;
    shadow.t_max = 1.0f - kShadowShortening - snapshot_.extent() * 0x1p-18f / light.distance;
  }
  if constexpr (F.media) return transmission(shadow);
  return shadow.t_max > 0.0f && occluded(shadow) ? V3f(0.0f) : V3f(1.0f);
}

/// What the shadow ray's media let pass; nothing if it meets more than interfaces.
template <Features F>
V3f Path<F>::transmission(Ray shadow) {
  Interiors interiors = interiors_;
  MediumRandom random(sampler_.next_2d());
  const float length = shadow.dir.length();  // finite lights' directions reach from here to there
  shadow.dir /= length;
  shadow.t_max *= length;
  V3f share(1.0f);
  for (int crossing = 0; shadow.t_max > 0.0f && crossing < kMostCrossings; ++crossing) {
    const std::optional<Hit> hit = closest(shadow);
    if (hit && !snapshot_.object(hit->object).material->is_interface) return V3f(0.0f);
    if (!interiors.empty()) {
      const Medium& medium = *snapshot_.object(interiors.innermost()).interior;
      share *= transmittance(medium, shadow.origin, shadow.dir, hit ? hit->t : shadow.t_max, random);
      if (is_black(share)) return share;
    }
    if (!hit) return share;
    const ObjectState& object = snapshot_.object(hit->object);
    const Surface surface = surface_of(object, *hit, object.mesh == nullptr ? footprint_at(hit->t) : 0.0f);
    cross_boundary(interiors, object, hit->object, shadow.dir, surface);
    shadow.origin = offset_origin(surface, shadow.dir);
    shadow.t_max -= hit->t;
    shadow.seed += kRaySeedStep;
  }
  return share;
}

template <Features F>
bool Path<F>::scatter_in_medium(const Medium& medium, float t) {
  const V3f position = ray_.origin + ray_.dir * t;
  if (depth_ == 0) {
    // The medium is taken to stand still.
    see_primary(interiors_.innermost(), t, {V3d(position), V3d(position)});
    if constexpr (F.guides) result_.guides.albedo = clamp_to_unit(throughput_);
  } else if (F.guides && scatterings_ == 0) {
    result_.guides.albedo = clamp_to_unit(throughput_ / radiance_scale_);
  }
  if (depth_ == integrator_.max_depth) return false;

  const float u_light = sampler_.next_1d();
  const V2f u_light_point = sampler_.next_2d();
  const V2f u_phase = sampler_.next_2d();
  const float u_roulette = sampler_.next_1d();
  const float g = mean_cosine(medium);
  if (draws_lights_) gather_direct_light_in_medium(position, g, u_light, u_light_point);
  const PhaseSample scattered = sample_henyey_greenstein(g, -ray_.dir, u_phase);
  ++scatterings_;
  material_pdf_ = scattered.pdf_solid_angle;
  previous_position_ = position;
  if constexpr (F.textures)
    differential_ = becalm::tracer::scattered(differential_, scattered.wi, kScatteredSpread);
  ray_.origin = position;
  ray_.dir = scattered.wi;
  return survives_roulette(u_roulette);
}

template <Features F>
void Path<F>::gather_direct_light_in_medium(const V3f& position, float g, float u_light, const V2f& u) {
  const std::optional<LightSample> light = snapshot_.lights().sample(position, time_, u_light, u);
  if (!light) return;
  const float phase = phase_henyey_greenstein(g, -ray_.dir, light->dir_world);
  V3f contribution = light->radiance * (phase / light->pdf_solid_angle);
  if (is_black(contribution)) return;
  if (integrator_.direct == Direct::mis && !light->delta)
    contribution *= mis_weight(integrator_.heuristic, light->pdf_solid_angle, phase);
  gather(throughput_ * contribution * visibility(position, position, *light), scatterings_ + 1, light->group);
}

template <Features F>
PathSample trace_path(const PathContext& context, const V2f& raster, Sampler& sampler) {
  return Path<F>(context, raster, sampler).trace();
}

/// A compiled variant. The first that can do all that is needed is taken, so each row adds to those before.
struct Variant {
  Features features;
  PathFunction function;
};
template <Features F>
constexpr Variant kVariant{F, &trace_path<F>};

template <bool kGuides>
constexpr std::array kVariants = {
    kVariant<Features{false, false, false, false, kGuides}>,
    kVariant<Features{.surfaces = true, .textures = false, .media = false, .blur = false, .guides = kGuides}>,
    kVariant<Features{.surfaces = true, .textures = true, .media = false, .blur = false, .guides = kGuides}>,
    kVariant<Features{.surfaces = true, .textures = true, .media = false, .blur = true, .guides = kGuides}>,
    kVariant<Features{.surfaces = true, .textures = true, .media = true, .blur = true, .guides = kGuides}>,
};

}  // namespace

PathFunction select_path_function(const SceneNeeds& needs, bool with_guides) {
  const bool textures = needs.textures || needs.procedurals || needs.relief || needs.mix || needs.tangents;
  const bool surfaces = needs.specular || needs.rough_specular || needs.alpha;
  const bool blur = needs.motion_blur || needs.depth_of_field;
  for (const auto& [has, function] : with_guides ? kVariants<true> : kVariants<false>) {
    if (has.surfaces >= surfaces && has.textures >= textures && has.media >= needs.media && has.blur >= blur)
      return function;
  }
  assert(false);
  return nullptr;
}

}  // namespace becalm::tracer
