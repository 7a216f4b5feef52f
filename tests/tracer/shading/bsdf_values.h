#pragma once

#include "tracer/materials/bsdf.h"

namespace becalm::tracer {

/// f |cos wi|.
inline V3f value_of(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  return evaluate(bsdf, wo, wi).f_cos;
}

/// Density per solid angle.
inline float pdf_of(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  return evaluate(bsdf, wo, wi).pdf_solid_angle;
}

}  // namespace becalm::tracer
