#pragma once

#include "tracer/math/ray_differential.h"
#include "tracer/mis.h"
#include "tracer/path_trace.h"
#include "tracer/shading_vertex.h"

// The estimator
//
// Let x_0 be the eye, x_1, x_2, ... the vertices of a path, and L(x_k) the radiance that leaves x_k towards
// x_{k-1}. Then
//
//   L(x_k) = Le(x_k) + int over the unit sphere of f_k(wi) |cos wi| L(x_{k+1}(wi)) dwi
//
// with x_{k+1}(wi) the first surface in direction wi, or the environment. The indirect part of the integral
// is estimated by one direction wi from the material's density p_m (per solid angle): the throughput T_{k+1}
// = T_k f_k |cos| / p_m carries on to x_{k+1}. The direct part, with Le(x_{k+1}) in place of L, is estimated
// twice, by that same direction and by one from the lights' density p_l (also per solid angle, including the
// choice of the light), and the two are combined with weights that add up to 1 wherever both may be drawn
// (Veach and Guibas 1995):
//
//   T_k f_k(w_l) |cos w_l| V(w_l) Le / p_l(w_l) * w_light(w_l)  +  T_{k+1} Le(x_{k+1}) * w_material(w_m)
//
//   w_light = h(p_l, p_m),  w_material = h(p_m, p_l),  h(a, b) = a^n / (a^n + b^n)
//
// with n = 2 for the power and n = 1 for the balance heuristic.
//
// A delta lobe has no density that lights could be drawn against: after it, and at x_1, where no light was
// drawn, Le counts whole. `direct: light` and `direct: material` set one weight to 1 and the other to 0, so
// that the three must agree in expectation, which tests hold. The path ends after max_depth scattering
// events; from roulette_depth on it survives those that are not delta lobes with probability
// q = min(1, max T), after which T is divided by q, which keeps the expectation. Radiance grows and shrinks
// by the squared index of refraction while inside glass; q leaves that factor out.

namespace becalm::tracer {

/// What a variant of the integrator can do, as PathVariant says; false removes the code.
struct Features {
  bool surfaces;
  bool textures;
  bool media;
  bool blur;
  bool guides;
};

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Rays that left a rough surface see textures blurred by this angle in radians: about the spacing of the few
/// directions that a pixel sends into the hemisphere.
inline constexpr float kScatteredSpread = 0.1f;

/// Shadow rays end short of the light by this share of the way (and by rounding errors), so as not to hit it.
inline constexpr float kShadowShortening = 1e-4f;

/// Interfaces that a path crosses at most: rounding may find one again and again.
inline constexpr int kMostCrossings = 1000;

/// The random numbers of one light sample, in [0,1).
struct LightNumbers {
  float light;
  V2f point;
  V2f shadow;  ///< of the media on the way; only with media
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
        draws_lights_(integrator_.direct != Direct::material && !snapshot_.lights().empty() &&
                      !context.guides_only) {
    if constexpr (F.blur) {
      // Both are always drawn, so that the later dimensions do not depend on which of the two the scene has.
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
    while (step() && !(context_.guides_only && scatterings_ > 0)) {
    }
    return result_;
  }

 private:
  void start(const Camera& camera, const V2f& raster, const std::optional<V2f>& u_lens) {
    ray_ = u_lens ? camera.ray(raster, *u_lens) : camera.ray(raster);
    if constexpr (F.textures) {
      // The pinhole's: the samples themselves average over the lens.
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
  void see_primary_medium(float t);
  bool cross_interface(const ObjectState& object, const Hit& hit, const Surface& surface);
  bool scatter_in_medium(const Medium& medium, float t);
  void gather_direct_light_in_medium(const V3f& position, float g, const LightNumbers& u);
  void gather_emission(const ObjectState& object, const Hit& hit, const Surface& surface);
  bool scatter(const ObjectState& object, const Hit& hit, Surface& surface);
  const Bsdf& shade(const ObjectState& object, const Hit& hit, Surface& surface, float u_mix,
                    std::optional<Bsdf>& local, V3f& tangent);
  void bend_differential(const ObjectState& object, const Hit& hit, const V3f& normal,
                         const BsdfSample& scattered, const V3f& wi_world);
  V3f transmission(Ray shadow, float skipped, Interiors interiors, const V2f& u);
  V3f visibility(const V3f& from, const V3f& position, float skipped, const LightSample& light,
                 const Interiors& interiors, const V2f& u);
  bool survives_roulette(float u);
  void gather_direct_light(const ObjectState& object, std::uint32_t number, const ShadingVertex& vertex,
                           const LightNumbers& u);

  /// Gives the next ray its own opacity decisions.
  void next_ray_seed() { ray_.seed += kRaySeedStep; }

  std::optional<Hit> closest(const Ray& ray) const {
    if (context_.rays != nullptr) context_.rays->push_back({ray, false});
    return snapshot_.intersector().closest(ray);
  }
  bool occluded(const Ray& ray) const {
    if (context_.rays != nullptr) context_.rays->push_back({ray, true});
    return snapshot_.intersector().occluded(ray);
  }

  /// Of a distance from where the ray left the surface: what is nearer than its origin happens there, since
  /// rounding decides on which side of the surface that lies.
  float beyond_origin(float t) const { return std::max(0.0f, t - skipped_); }

  /// By value where the object may move while the shutter is open.
  std::conditional_t<F.blur, Place, const Place&> place_of(const ObjectState& object) const {
    if constexpr (F.blur) {
      if (object.blurred()) return object.at(time_);
    }
    return object.place;
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

  /// Weight of light that the ray hit, where light sampling finds it with density light_pdf().
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
  Lights::Received previous_;     // what lights send there; where light sampling had a chance
  float material_pdf_ = 0.0f;     // of the ray's direction; 0 where light sampling had no chance
  Interiors interiors_;           // what the ray's origin lies in; only with media
  float skipped_ = 0.0f;          // before the ray's origin, from the surface on; only with media
  float travelled_ = 0.0f;        // to the ray's origin from the last scattering, through interfaces
  int crossings_ = 0;             // of interfaces
  int depth_ = 0;                 // scattering events so far
  int scatterings_ = 0;           // those other than at perfect mirrors and glass
};

}  // namespace becalm::tracer
