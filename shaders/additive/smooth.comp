// Reads an additive AOV, the features, the window's weights and the kernels that smooth/regress made from them for the
// beauty; writes the AOV smoothed by the same kernels. A pixel that the beauty does not smooth stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/smooth_params.h"

layout(constant_id = 0) const int radius = 5;

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { SmoothParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 3) uniform samplerBuffer normal;
layout(set = 0, binding = 4) uniform usamplerBuffer weights;
layout(set = 0, binding = 5) uniform samplerBuffer kernel;
layout(std430, set = 0, binding = 6) writeonly buffer SmoothedBuffer { vec4 data[]; } smoothed;

#include "lib/smoothing_kernel.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const int pixels = p.width * p.height;
  const vec4 k = texelFetch(kernel, index);
  const vec3 value = apply_smoothing_kernel(at, radius, k, texelFetch(kernel, pixels + index));
  const vec4 own = texelFetch(color, index);
  smoothed.data[index] = k.x > 0.0 ? vec4(value * texelFetch(kernel, 2 * pixels + index).rgb, own.a) : own;
}
