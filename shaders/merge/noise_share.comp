// Reads an estimate of each pixel's variance, the patch sums of merge/noise_scales and the ratio of the frame's noise
// (filter/input/noise_ratio.h); writes the estimate without the part that is detail, and with what neighbours share of
// the noise. Where taps at distance 2 differ much more than taps at distance 1, most of the difference is detail.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int has_albedo = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer estimate;
layout(set = 0, binding = 1) uniform samplerBuffer scales_sums;
layout(set = 0, binding = 2) uniform samplerBuffer noise_ratio;
layout(std430, set = 0, binding = 3) writeonly buffer VarianceBuffer { vec2 data[]; } variance;

/// Ratios, in units of the noise's, up to which a patch may be all noise, and from which it is all detail. In patches
/// of noise the ratio spreads to twice its mean; detail of references has 5 to 12.
const float kNoise = 3.0;
const float kDetail = 6.0;
/// Of the estimate, what remains of detail.
const float kLeastShare = 0.1;
/// Both estimates miss a part of the noise that neighbours share; the noise's ratio to this power makes up for it. For
/// the fit over 3x3 pixels, which follows such noise, the power is 0.3 to 0.45 with kernels of a pixel's width and
/// features that explain nothing; for second differences it is 1, since they are what the ratio is made of.
const float kSharedPower = has_albedo != 0 ? 0.5 : 1.0;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 sum = texelFetch(scales_sums, index);
  const float of_noise = texelFetch(noise_ratio, 0).x;
  const float ratio = sum.x > 0.0 ? sum.y / (sum.x * of_noise) : 1.0;
  const float share = clamp((kDetail - ratio) / (kDetail - kNoise), kLeastShare, 1.0);
  const vec2 estimated = texelFetch(estimate, index).xy;
  variance.data[index] = vec2(estimated.x * share * pow(of_noise, kSharedPower), estimated.y);
}
