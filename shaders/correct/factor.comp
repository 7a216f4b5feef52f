// Reads the relative differences of one level's blocks and the factors of the coarser level; writes this level's factors.
// The estimate is scaled towards the frame by the share of the difference that is not the frame's noise, P / (P + V)
// (Wiener). P is measured over the 5x5 blocks around, so that no block decides alone about the weight of its own noise.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/correct_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { BlockParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer difference;
layout(set = 0, binding = 1) uniform samplerBuffer base;
layout(set = 0, binding = 2) uniform samplerBuffer coarser;
layout(std430, set = 0, binding = 3) writeonly buffer FactorBuffer { vec4 data[]; } factor;

#include "lib/read_factor.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const ivec2 size = ivec2(p.width, p.height);
  vec3 mean = vec3(0.0);
  vec3 base_mean = vec3(0.0);
  float squares = 0.0;
  float noise = 0.0;
  [[unroll]] for (int j = -2; j <= 2; ++j) {
    [[unroll]] for (int i = -2; i <= 2; ++i) {
      const ivec2 tap = clamp(at + ivec2(i, j), ivec2(0), size - 1);
      const vec4 d = texelFetch(difference, tap.y * size.x + tap.x);
      squares += dot(d.rgb, d.rgb) / 3.0;
      noise += d.a;
      if (abs(i) > 1 || abs(j) > 1) continue;
      const float w = (i == 0 ? 2.0 : 1.0) * (j == 0 ? 2.0 : 1.0);
      mean += w * d.rgb;
      base_mean += w * texelFetch(base, tap.y * size.x + tap.x).rgb;
    }
  }
  const float share = squares > noise ? 1.0 - noise / squares : 0.0;
  const vec3 scale = clamp(1.0 + share * mean / max(base_mean, vec3(1e-6)), vec3(0.5), vec3(2.0));
  factor.data[at.y * p.width + at.x] = vec4(read_factor(at, ivec2(p.width_in, p.height_in), 2.0) * scale, 1.0);
}
