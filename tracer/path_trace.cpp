#include "tracer/path_trace.h"

#include <array>
#include <cassert>

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
  bool surfaces;  ///< materials other than plain diffuse ones
  bool blur;      ///< the shutter is open for a time, or the lens has a width
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
      if (context.cameras.moves()) {
        const Camera camera = context.cameras.current(time_);
        ray_ = camera.ray(raster, u_lens);
      } else {
        ray_ = context.cameras.current().ray(raster, u_lens);
      }
      ray_.time = time_;
    } else {
      ray_ = context.cameras.current().ray(raster);
    }
    if constexpr (F.surfaces) ray_.seed = sampler.seed_of_rays();
    cone_spread_ = kTextureFootprintPx / static_cast<float>(context.cameras.current().focal_px());
  }

  PathSample trace() {
    while (step()) ++depth_;
    return result_;
  }

 private:
  /// Follows the ray to what it meets and scatters there; false when the path ends.
  bool step();
  void escape();
  void see_primary_hit(const ObjectState& object, const Hit& hit);
  void gather_emission(const ObjectState& object, const Hit& hit, const Surface& surface);
  bool scatter(const ObjectState& object, const Surface& surface);
  void gather_direct_light(const Vertex& vertex, float u_light, const V2f& u);

  /// Each ray decides anew what it passes through.
  void next_ray_seed() { ray_.seed += 0x9e3779b9u; }

  std::optional<Hit> closest() const {
    if (context_.rays != nullptr) context_.rays->push_back({ray_, false});
    return snapshot_.intersector().closest(ray_);
  }
  bool occluded(const Ray& ray) const {
    if (context_.rays != nullptr) context_.rays->push_back({ray, true});
    return snapshot_.intersector().occluded(ray);
  }

  Surface surface_of(const ObjectState& object, const Hit& hit) const {
    if (F.blur && object.blurred()) return surface_at(object, object.at(time_), hit);
    return surface_at(object, object.place, hit);
  }

  auto bsdf_of(const Material& material, const Surface& surface) const {
    if constexpr (F.surfaces) {
      if (material.texture) {
        return Bsdf(DiffuseBsdf{context_.textures.color(*material.texture, surface.uv,
                                                        cone_width_ * surface.uv_per_length)});
      }
    }
    return material.bsdf;
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
    return integrator_.direct == Direct::light ? 0.0f
                                               : mis_weight(integrator_.heuristic, material_pdf_, light_pdf());
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
  float radiance_scale_ = 1.0f;  // squared index of refraction contained in the throughput
  float cone_width_ = 0.0f;      // diameter of the ray cone at the ray's origin
  float cone_spread_;
  V3f previous_position_;      // of the vertex that the ray left, without the offset
  float material_pdf_ = 0.0f;  // of the ray's direction; 0 where light sampling had no chance
  int depth_ = 0;              // scattering events so far
  int scatterings_ = 0;        // those other than at perfect mirrors and glass
};

template <Features F>
bool Path<F>::step() {
  const std::optional<Hit> hit = closest();
  if (!hit) {
    escape();
    return false;
  }
  const ObjectState& object = snapshot_.object(hit->object);
  const Surface surface = surface_of(object, *hit);
  cone_width_ += cone_spread_ * hit->t;
  if (depth_ == 0) see_primary_hit(object, *hit);
  gather_emission(object, *hit, surface);
  if (context_.log != nullptr) {
    context_.log->push_back({hit->object, surface.position, throughput_, result_.radiance});
  }
  return scatter(object, surface);
}

template <Features F>
void Path<F>::escape() {
  if (depth_ == 0) result_.covered = snapshot_.description().environment.has_value();
  snapshot_.lights().for_each_infinite(ray_.dir, [&](const V3f& radiance, float pdf, std::uint16_t group) {
    if (!is_black(radiance)) gather(throughput_ * radiance * weight([&] { return pdf; }), scatterings_, group);
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

template <Features F>
void Path<F>::see_primary_hit(const ObjectState& object, const Hit& hit) {
  result_.covered = true;
  if constexpr (F.guides) {
    const PointMotion point = point_motion(object, hit, time_);
    Guides& guides = result_.guides;
    guides.depth = hit.t;
    guides.motion = motion(context_.cameras.current(time_).project(point.current),
                           context_.cameras.previous(time_).project(point.previous));
    guides.ids = {hit.object + 1, snapshot_.description().objects[hit.object].material + 1};
  }
}

template <Features F>
void Path<F>::gather_emission(const ObjectState& object, const Hit& hit, const Surface& surface) {
  const V3f radiance = emitted(object, surface, ray_.dir);
  if (is_black(radiance)) return;
  const float mis = weight([&] {
    if (object.mesh == nullptr) return snapshot_.lights().pdf_sphere(object.first_light, previous_position_, time_);
    const float distance = (surface.position - previous_position_).length();
    return snapshot_.lights().pdf_triangle(object.first_light + std::size_t{hit.triangle}, previous_position_,
                                           ray_.dir, distance, time_);
  });
  gather(throughput_ * radiance * mis, scatterings_, object.light_group);
}

template <Features F>
bool Path<F>::scatter(const ObjectState& object, const Surface& surface) {
  const bool wants_guides = F.guides && scatterings_ == 0;
  const bool last = depth_ == integrator_.max_depth;
  if (last && !wants_guides) return false;
  const Bsdf bsdf = bsdf_of(*object.material, surface);
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

  const ShadingFrame frame = ShadingFrame::from_normal(normal);
  const Vertex vertex{surface, bsdf, frame, wo_world, frame.to_local(wo_world)};
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
  if (!scattered->specular) cone_spread_ = std::max(cone_spread_, kScatteredSpread);
  previous_position_ = surface.position;

  // A path that may still meet the surface of albedo and normal must get there.
  if (depth_ + 1 >= integrator_.roulette_depth && scatterings_ > 0) {
    const float survival = std::min(0.95f, max_component(throughput_) / radiance_scale_);
    if (u_roulette >= survival) return false;
    throughput_ /= survival;
  }
  ray_.origin = offset_origin(surface, wi_world);
  ray_.dir = wi_world;
  next_ray_seed();
  return true;
}

/// The light sample's part of the direct light.
template <Features F>
void Path<F>::gather_direct_light(const Vertex& vertex, float u_light, const V2f& u) {
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
  next_ray_seed();
  Ray shadow = ray_;
  shadow.origin = offset_origin(vertex.surface, light->dir_world);
  shadow.dir = light->dir_world;
  if (light->distance < kInfinity) {
    shadow.dir = position + light->dir_world * light->distance - shadow.origin;
    shadow.t_max = 1.0f - kShadowShortening - snapshot_.extent() * 0x1p-18f / light->distance;
  }
  if (shadow.t_max > 0.0f && occluded(shadow)) return;
  gather(throughput_ * contribution, scatterings_ + 1, light->group);
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

constexpr std::array kVariants = {
    kVariant<Features{.surfaces = false, .blur = false, .guides = false}>,
    kVariant<Features{.surfaces = false, .blur = false, .guides = true}>,
    kVariant<Features{.surfaces = true, .blur = false, .guides = false}>,
    kVariant<Features{.surfaces = true, .blur = false, .guides = true}>,
    kVariant<Features{.surfaces = true, .blur = true, .guides = false}>,
    kVariant<Features{.surfaces = true, .blur = true, .guides = true}>,
};

}  // namespace

PathFunction select_path_function(const SceneNeeds& needs, bool with_guides) {
  const bool surfaces = needs.specular || needs.rough_specular || needs.textures;
  const bool blur = needs.motion_blur || needs.depth_of_field;
  for (const auto& [has, function] : kVariants) {
    if (has.surfaces >= surfaces && has.blur >= blur && has.guides >= with_guides) return function;
  }
  assert(false);
  return nullptr;
}

}  // namespace becalm::tracer
