// Reads an additive AOV, the features, the window's weights and the kernels that smooth/regress made from them for the
// beauty; writes the AOV smoothed by the same kernels. A pixel that the beauty does not smooth stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/patch_weights.glsl"
#include "lib/reflectance.glsl"
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

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const int shifts = (2 * radius + 1) * (2 * radius + 1);
  const int planes = (shifts + kShiftsPerPlane - 1) / kShiftsPerPlane;
  const vec4 albedo_depth_here = texelFetch(albedo_depth, index);
  const vec3 normal_here = texelFetch(normal, index).xyz;
  const vec4 k = texelFetch(kernel, index);
  const vec4 of_albedo_depth = texelFetch(kernel, p.width * p.height + index);
  vec3 sum = vec3(0.0);
  for (int plane = 0; plane < planes; ++plane) {
    const uint packed = texelFetch(weights, (plane * p.height + at.y) * p.width + at.x).x;
    [[unroll]] for (int i = 0; i < kShiftsPerPlane; ++i) {
      const ivec2 q = clamp(at + window_shift(plane * kShiftsPerPlane + i, radius), ivec2(0), ivec2(p.width, p.height) - 1);
      const int tap = q.y * p.width + q.x;
      const float w = float((packed >> (8 * i)) & 255u) / 255.0 * texelFetch(variance, tap).y;
      const vec4 surface = texelFetch(albedo_depth, tap);
      const vec3 n = texelFetch(normal, tap).xyz - normal_here;
      const float share = k.x - dot(k.yzw, n) - dot(of_albedo_depth, surface - albedo_depth_here);
      sum += w * share * (texelFetch(color, tap).rgb / divisor_of(surface.rgb));
    }
  }
  const vec4 own = texelFetch(color, index);
  smoothed.data[index] = k.x > 0.0 ? vec4(sum * divisor_of(albedo_depth_here.rgb), own.a) : own;
}
