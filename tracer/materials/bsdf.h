#pragma once

#include <optional>
#include <variant>

#include "tracer/math/vec.h"

namespace becalm::tracer {

// Directions are unit vectors in the local shading frame: z is the shading normal, and wo (to the eye) and wi
// (to the light) both point away from the surface, so that |cos| is |w.z|. Paths are traced from the eye:
// values are those of radiance transport, where crossing an interface scales radiance by (n_wo / n_wi)^2.

/// Lambertian; reflects on both sides.
struct DiffuseBsdf {
  V3f reflectance;  ///< [0,1]
};

/// Metal with the complex index of refraction eta + i k against air; reflects on both sides. GGX microfacets
/// with all their scattering (multiple_scattering.h). eta = 0 reflects everything.
struct ConductorBsdf {
  V3f eta;
  V3f k;
  float alpha;  ///< GGX width in [0,1]; below kSmoothAlpha a perfect mirror
  // What follows from these.
  V3f facing;                   ///< reflectance at normal incidence
  V3f further_gain{0.0f};       ///< of the lobe of further bounces
  float further_albedo = 0.0f;  ///< mean of that lobe for light that one bounce loses, strongest channel

  ConductorBsdf(const V3f& eta, const V3f& k, float alpha);
};

/// Clear interface: reflects and refracts, GGX microfacets (Walter et al. 2007) with all their scattering
/// (multiple_scattering.h).
struct DielectricBsdf {
  float eta;    ///< index of refraction inside (below the normal) over outside, > 0; 1 lets everything pass
                ///< straight
  float alpha;  ///< GGX width in [0,1]; see is_specular
  V3f transmittance;  ///< [0,1], tint of what crosses the interface
  // What follows from these, of a rough interface.
  float lost_outside = 1.0f;  ///< mean share of light from there that one scattering loses
  float lost_inside = 1.0f;
  float crossing = 0.0f;  ///< share of light from outside that Fresnel's reflectance lets through on average

  DielectricBsdf(float eta, float alpha, const V3f& transmittance);
};

/// Layers of a clear coat and a sheen over a base of metal, glass and diffuse reflection under a dielectric's
/// highlight; made by make_principled (principled.h), which names the parameters. Everything reflects on both
/// sides. The model is derived in principled.inl.
struct PrincipledBsdf {
  V3f base_color;
  float metal;   ///< share of the base
  float glass;   ///< share of the base; the rest is diffuse under a dielectric
  float eta;     ///< as DielectricBsdf's
  float f0;      ///< reflectance of the dielectric at normal incidence
  float alpha;   ///< geometric mean of the GGX widths; below kSmoothAlpha a mirror
  float aspect;  ///< root of the ratio of the widths across and along the tangent, turned by the rotation
  float rotation_cos;
  float rotation_sin;
  V3f multiple;        ///< colour of what metal and dielectric scatter more than once, over 1 - mean albedo
  float multiple_f0;   ///< of the dielectric alone, without that divisor
  float diffuse_gain;  ///< 1 / (1 - mean albedo of the dielectric)
  V3f sheen;
  float coat;
  float coat_alpha;
};

/// A new model is an .inl, an entry here, and what bsdf.cpp says of models (transmits_model, widen_model);
/// ../README.md has the rest of the way.
using Bsdf = std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, PrincipledBsdf>;

/// Lobes narrower than this many radians are handled as delta functions: 32-bit directions could not resolve
/// them.
inline constexpr float kSmoothAlpha = 1e-4f;

struct BsdfSample {
  V3f wi;
  V3f weight;             ///< f |cos wi| / pdf, each channel finite and >= 0
  float pdf_solid_angle;  ///< as evaluate() gives it; 0 for delta lobes
  bool specular;          ///< came from a delta lobe
  bool transmitted;       ///< wi lies on the other side than wo
  float radiance_scale;   ///< (n_wo / n_wi)^2 as contained in weight; Russian roulette should divide it out
};

/// Both are zero for delta lobes and where wo or wi is tangential to the surface.
struct BsdfValue {
  V3f f_cos;              ///< f |cos wi|
  float pdf_solid_angle;  ///< density with which sample() finds wi
};
BsdfValue evaluate(const Bsdf& bsdf, const V3f& wo, const V3f& wi);

/// Draws wi from u in [0,1)^2 and u_lobe in [0,1), the latter choosing among lobes. Nothing when the drawn
/// path carries no light: absorbed, masked by the microsurface, or wo tangential; this is part of the
/// estimate, do not draw again.
std::optional<BsdfSample> sample(const Bsdf& bsdf, const V3f& wo, const V2f& u, float u_lobe);

/// Whether all lobes are delta functions, so that light sampling can find nothing.
bool is_specular(const Bsdf& bsdf);

/// Whether light may come from the other side than wo.
bool transmits(const Bsdf& bsdf);

/// Reflectance in [0,1] for the albedo AOV: of conductors at normal incidence, of dielectrics what they
/// reflect and transmit together there.
V3f albedo(const Bsdf& bsdf);

/// Widens microfacet lobes by slopes of that variance, which are no longer in the normal (alpha^2 grows by
/// it, as in LEAN mapping: Olano and Baker 2010).
void widen(Bsdf& bsdf, float slope_variance);

/// alpha = roughness^2, clamped to [0,1].
float roughness_to_alpha(float roughness);

}  // namespace becalm::tracer
