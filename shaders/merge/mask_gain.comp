// Reads the new frame, the warped history and the aligner's residual patch distance eps at one level; writes
// the merged frame. The history's weight is clamp(alpha (1 - m), 0, 1) with m = kappa eps - eta (Hanika et
// al. 2021, section 3.2). Differs from the paper: m is clamped to [0,1], since a negative m would raise the
// weight above alpha, up to a history that never fades; and a history of n frames weighs at most n/(n+1), so
// that the first frames are averaged evenly.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/bilinear.glsl"
#include "lib/gain.glsl"
#include "shared/limits.h"
#include "shared/merge_params.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 residual_size; MaskGainParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer warped_color;
layout(set = 0, binding = 3) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 4) uniform samplerBuffer residual;
layout(std430, set = 0, binding = 5) writeonly buffer MergedColorBuffer { vec4 data[]; } merged_color;
layout(std430, set = 0, binding = 6) writeonly buffer MergedStatsBuffer { vec2 data[]; } merged_stats;
layout(std430, set = 0, binding = 7) writeonly buffer DecisionBuffer { vec4 data[]; } decision;

/// Of the paper's equation above. Between distances of 1 and 1.5 the history's weight falls from kAlpha to 0.
const float kAlpha = 0.9;
const float kKappa = 2.0;
const float kEta = 2.0;

#include "lib/blend.glsl"

/// The residual at the pixel's centre, read bilinearly from an image of equal or lower resolution.
float read_residual(ivec2 at) {
  const BilinearTaps taps = bilinear_taps(at, vec2(0.0), residual_size, p.residual_scale);
  return bilinear_value(residual, taps, residual_size.x, 0);
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const float n = min(texelFetch(warped_stats, index).y, kMostFrames - 1.0);
  const float rejected = clamp(kKappa * read_residual(at) - kEta, 0.0, 1.0);
  const float history_weight = min(kAlpha * (1.0 - rejected), n / (n + 1.0));
  // Added to the prediction's variance, it multiplies the inverse variance by (1 - rejected).
  const float distrust = min(texelFetch(warped_stats, index).x * rejected / max(1.0 - rejected, 1e-6), kLargestVariance);
  blend(index, 1.0 - history_weight, 0.0, rejected, distrust);
}
