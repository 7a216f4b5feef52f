// Reads a frame that came without variance; writes an estimate of each pixel's variance: the squared response of the
// Laplacian difference mask, which annihilates planes (Immerkaer 1996, "Fast noise variance estimation"). Detail inflates
// it, so a renderer's own variance or half-buffers are better wherever they exist.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/gain.glsl"
#include "shared/merge_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { ImageParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer valid;
layout(std430, set = 0, binding = 2) writeonly buffer VarianceBuffer { vec2 data[]; } variance;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  // At the border the mask is that of the nearest pixel with eight neighbours: folded back it would understate.
  const ivec2 size = ivec2(p.width, p.height);
  const ivec2 center = min(max(at, ivec2(1)), max(size - 2, ivec2(0)));
  // The mask (1 -2 1) x (1 -2 1), of which the squares add up to 36.
  vec3 response = vec3(0.0);
  [[unroll]] for (int j = -1; j <= 1; ++j) {
    [[unroll]] for (int i = -1; i <= 1; ++i) {
      const ivec2 tap = clamp(center + ivec2(i, j), ivec2(0), size - 1);
      const float w = (i == 0 ? -2.0 : 1.0) * (j == 0 ? -2.0 : 1.0);
      response += w * texelFetch(color, tap.y * p.width + tap.x).rgb;
    }
  }
  const int index = at.y * p.width + at.x;
  const float estimate = min(dot(response, response) / (3.0 * 36.0), kLargestVariance);
  variance.data[index] = vec2(estimate, texelFetch(valid, index).y);
}
