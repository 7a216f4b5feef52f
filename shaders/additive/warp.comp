// Reads the history of an additive AOV as merge/warp_history reads the beauty's, with the share of the sharp filter that the
// beauty has: what adds up before adds up afterwards. There is no clamp, since the range of one AOV is not that of another.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/merge_params.h"

layout(constant_id = 0) const int resample = 1;     // as in lib/resample.glsl
layout(constant_id = 1) const int demodulated = 0;  // as in merge/warp_history

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { WarpHistoryParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer history_color;
layout(set = 0, binding = 2) uniform samplerBuffer resample_taps;
layout(set = 0, binding = 3) uniform samplerBuffer history_stats;
layout(set = 0, binding = 4) uniform samplerBuffer target_origin;
layout(set = 0, binding = 5) uniform samplerBuffer albedo;
layout(set = 0, binding = 6) uniform samplerBuffer share;
layout(std430, set = 0, binding = 7) writeonly buffer WarpedBuffer { vec4 data[]; } warped;

#include "lib/read_history.glsl"
#include "lib/reflectance.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const HistoryRead h = read_history(at, index);
  const vec4 color = h.bilinear + texelFetch(share, index).x * (h.sharp - h.bilinear);
  const vec3 scale = demodulated != 0 ? divisor_of(texelFetch(albedo, index).rgb) : vec3(1.0);
  warped.data[index] = h.found ? color * vec4(scale, 1.0) : vec4(0.0);
}
