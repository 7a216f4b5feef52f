#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracer/math/shading_frame.h"
#include "tracer/math/vec.h"

// The phase function of Henyey and Greenstein ("Diffuse radiation in the galaxy", 1941) with mean cosine g in
// (-1,1): the density per solid angle of the direction wi in which light is scattered on,
//
//   p = 1/(4 pi) (1 - g^2) / (1 + g^2 - 2 g cos)^(3/2),   cos = -wo . wi.
//
// As everywhere, wo points to where the path came from and wi onward, both of unit length in world space, so
// that g > 0 scatters forward, along -wo. Symmetric in wo and wi.
//
// With a = |g| and the axis +-wo about which the lobe lies, the denominator is written
// 1 + g^2 - 2 g cos = (1 - a)^2 + 2 a (1 - cos_axis): a sum of positive terms, so that nothing cancels where
// the lobe is narrow, and nothing is divided by g.

namespace becalm::tracer {

struct PhaseSample {
  V3f wi;
  float pdf_solid_angle;  ///< also the phase function's value
};

/// 1 - cos of the angle between unit vectors, without cancellation where it is small.
inline float one_minus_cos(const V3f& a, const V3f& b) {
  return 0.5f * (a - b).length2();
}

/// Value and density per solid angle.
inline float phase_henyey_greenstein(float g, const V3f& wo, const V3f& wi) {
  const float a = std::abs(g);
  const V3f axis = g < 0.0f ? wo : -wo;
  const float distance2 = (1.0f - a) * (1.0f - a) + 2.0f * a * one_minus_cos(axis, wi);
  return (1.0f - a) * (1.0f + a) / (4.0f * std::numbers::pi_v<float> * distance2 * std::sqrt(distance2));
}

/// Draws wi from the phase function; u in [0,1)^2.
inline PhaseSample sample_henyey_greenstein(float g, const V3f& wo, const V2f& u) {
  // The inverse of the cumulative distribution of cos, solved for 1 - cos.
  const float a = std::abs(g);
  const float q = 1.0f - a + 2.0f * a * u.x;
  const float ratio = (1.0f - a) / q;
  const float drop = std::min(2.0f, 2.0f * ratio * ratio * (1.0f - u.x) * (1.0f + a * u.x));
  const float sin_theta = std::sqrt(drop * (2.0f - drop));
  const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
  const ShadingFrame frame = ShadingFrame::from_normal(g < 0.0f ? wo : -wo);
  const V3f wi = frame.to_world({sin_theta * std::cos(phi), sin_theta * std::sin(phi), 1.0f - drop});
  const float distance = (1.0f + a) * ratio;
  return {wi.normalized(),
          (1.0f - a) * (1.0f + a) / (4.0f * std::numbers::pi_v<float> * distance * distance * distance)};
}

}  // namespace becalm::tracer
