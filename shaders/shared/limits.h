// Limits that kernels and the C++ around them share; read by C++ and GLSL alike.
#ifndef BECALM_LIMITS_H
#define BECALM_LIMITS_H

#ifdef __cplusplus
namespace becalm::filter {
#endif

/// Variances are clamped to this, so that their sums stay within the range of floats.
const float kLargestVariance = 1e34f;

/// Scaled colours of antialiased frames are limited to this, 2^60, so that their squares stay within the
/// range of floats.
const float kLargestScaled = 1152921504606846976.0f;

/// Both components of an offset that leads out of every image: the other eye does not see the pixel.
const float kNowhere = 1e6f;

/// Pixels on either side of its own that merge/spline_coefficients reads.
const int kSplineReach = 7;

#ifdef __cplusplus
}  // namespace becalm::filter
#endif
#endif
