#pragma once

#include "tracer/materials/bsdf.h"

namespace becalm::tracer {

/// What the principled model is asked for; all in [0,1] except `ior`.
struct PrincipledParameters {
  V3f base_color{0.8f};
  float metallic = 0.0f;             ///< share of the base that is metal with base_color at normal incidence
  float roughness = 0.5f;            ///< alpha = roughness^2
  float ior = 1.5f;                  ///< of what is not metal, inside over outside, > 0
  float anisotropy = 0.0f;           ///< 1: the highlight is ten times as long along the tangent as across
  float anisotropy_rotation = 0.0f;  ///< turns, counter-clockwise
  float sheen = 0.0f;                ///< weight of a dusty rim
  float sheen_tint = 0.0f;           ///< 0: the rim is white, 1: of base_color's hue
  float clearcoat = 0.0f;            ///< weight of a clear coat of index 1.5
  float clearcoat_roughness = 0.0f;
  float transmission = 0.0f;  ///< share of what is not metal that is clear, tinted by base_color
};

/// Values outside [0,1] are clamped, NaN counts as 0; an ior that is not positive and finite as 1.
PrincipledBsdf make_principled(const PrincipledParameters& parameters);

/// Scales what depends on the albedo of the base's lobe to its widths: further bounces within it, so that it
/// loses no energy and gains none, and the diffuse part below it.
void scale_to_lobe(PrincipledBsdf& bsdf);

}  // namespace becalm::tracer
