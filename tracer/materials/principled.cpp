#include "tracer/materials/principled.h"

#include <cmath>
#include <numbers>

#include "tracer/materials/multiple_scattering.h"
#include "tracer/materials/principled_albedo.h"

namespace becalm::tracer {

namespace {

float unit(float v) {
  return v > 0.0f ? std::min(v, 1.0f) : 0.0f;
}

}  // namespace

void scale_to_lobe(PrincipledBsdf& bsdf) {
  const GgxAlbedo mean_parts = PrincipledTables::get().mean_albedo(specular_shape(bsdf));
  const float mean = mean_parts.f0 + mean_parts.f90;
  const float metal_f90 = f90_of(max_component(bsdf.base_color));
  const float f90 = f90_of(bsdf.f0);
  const float dielectric = 1.0f - bsdf.metal - bsdf.glass;
  const float lost = std::max(0.0f, 1.0f - mean);
  const float gain = multiple_scattering_gain(mean);
  const float multiple = gain * multiple_scattering_color(bsdf.f0, f90, mean);
  bsdf.multiple_f0 = multiple * lost;
  for (int c = 0; c < 3; ++c) {
    const float metal = multiple_scattering_color(bsdf.base_color[c], metal_f90, mean);
    bsdf.multiple[c] = bsdf.metal * gain * metal + dielectric * multiple;
  }
  const float dielectric_mean = bsdf.f0 * mean_parts.f0 + f90 * mean_parts.f90 + bsdf.multiple_f0 * lost;
  bsdf.diffuse_gain = 1.0f / std::max(1e-5f, 1.0f - dielectric_mean);
}

PrincipledBsdf make_principled(const PrincipledParameters& parameters) {
  PrincipledBsdf bsdf;
  const V3f& color = parameters.base_color;
  bsdf.base_color = {unit(color.x), unit(color.y), unit(color.z)};
  bsdf.metal = unit(parameters.metallic);
  bsdf.glass = (1.0f - bsdf.metal) * unit(parameters.transmission);
  // Indices beyond these reflect more than 99.9%, and float does not resolve the rest.
  const float ior = parameters.ior;
  bsdf.eta = ior > 0.0f && std::isfinite(ior) ? std::clamp(ior, 1e-3f, 1e3f) : 1.0f;
  const float ratio = (bsdf.eta - 1.0f) / (bsdf.eta + 1.0f);
  bsdf.f0 = ratio * ratio;

  // The lobe is longer along the tangent by 1 / (1 - 0.9 anisotropy) (Burley, "Physically-Based Shading at
  // Disney", 2012), but not longer than 1.
  bsdf.alpha = roughness_to_alpha(unit(parameters.roughness));
  bsdf.aspect = std::max(kLeastAspect, std::sqrt(1.0f - 0.9f * unit(parameters.anisotropy)));
  if (bsdf.alpha > bsdf.aspect) {
    const float alpha_y = bsdf.alpha * bsdf.aspect;
    bsdf.alpha = bsdf.aspect = std::sqrt(alpha_y);
  }
  const float turns = parameters.anisotropy_rotation;
  const float angle =
      2.0f * std::numbers::pi_v<float> * (std::isfinite(turns) ? turns - std::floor(turns) : 0.0f);
  bsdf.rotation_cos = std::cos(angle);
  bsdf.rotation_sin = std::sin(angle);

  scale_to_lobe(bsdf);

  const float strongest = max_component(bsdf.base_color);
  const V3f hue = strongest > 0.0f ? bsdf.base_color / strongest : V3f(1.0f);
  const float tint = unit(parameters.sheen_tint);
  bsdf.sheen = (V3f(1.0f - tint) + hue * tint) * (unit(parameters.sheen) * (1.0f - bsdf.metal));
  bsdf.coat = unit(parameters.clearcoat);
  bsdf.coat_alpha = roughness_to_alpha(unit(parameters.clearcoat_roughness));
  return bsdf;
}

}  // namespace becalm::tracer
