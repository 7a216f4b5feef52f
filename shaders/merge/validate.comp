// Reads what the new frame's and the last frame's pixels show (lib/surface.glsl) and the offsets; writes how far the
// history there may be trusted (survey of Yang et al., section 4.1): (trust in [0,1], the rule of lib/rejection.glsl that
// doubts most). Depths, normals and object numbers cannot be averaged, so each of the four pixels that the history is
// read from is judged by itself, and their trusts are weighed bilinearly. Where offsets were searched there and back, their
// consistency is one more trust.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/rejection.glsl"
#include "lib/surface.glsl"
#include "shared/merge_params.h"

layout(constant_id = 0) const int by_depth = 1;
layout(constant_id = 1) const int by_normal = 1;
layout(constant_id = 2) const int by_id = 1;
layout(constant_id = 3) const int by_flow = 0;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ValidateParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer surface;
layout(set = 0, binding = 2) uniform samplerBuffer history_surface;
layout(set = 0, binding = 3) uniform samplerBuffer target_origin;
layout(set = 0, binding = 4) uniform samplerBuffer consistency;  // of align/consistency
layout(std430, set = 0, binding = 5) writeonly buffer TrustBuffer { vec2 data[]; } trust;

/// The unit vector of an octahedral pair, or zero.
vec3 unpack_normal(vec2 pair) {
  vec3 n = vec3(pair, 1.0 - abs(pair.x) - abs(pair.y));
  const float fold = max(-n.z, 0.0);
  n.xy += vec2(n.x >= 0.0 ? -fold : fold, n.y >= 0.0 ? -fold : fold);
  return pair.x < kNoNormal ? normalize(n) : vec3(0.0);
}

float inverse_depth(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), ivec2(p.width, p.height) - 1);
  return texelFetch(surface, inside.y * p.width + inside.x).x;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const vec4 here = texelFetch(surface, index);
  const vec3 normal = unpack_normal(here.zw);
  const float slope = surface_slope(inverse_depth(at - ivec2(1, 0)), here.x, inverse_depth(at + ivec2(1, 0))) +
                      surface_slope(inverse_depth(at - ivec2(0, 1)), here.x, inverse_depth(at + ivec2(0, 1)));
  const vec2 displacement = texelFetch(offset, index).xy;
  const vec2 base = floor(displacement);
  const vec2 t = displacement - base;
  const ivec2 nearest = at + ivec2(texelFetch(target_origin, 0).xy) + ivec2(base);
  float total = 0.0;
  vec3 by_rule = vec3(0.0);  // of depth, normal and id alone
  [[unroll]] for (int j = 0; j < 2; ++j) {
    [[unroll]] for (int i = 0; i < 2; ++i) {
      const ivec2 tap = clamp(nearest + ivec2(i, j), ivec2(0), ivec2(p.history_width, p.history_height) - 1);
      const vec4 there = texelFetch(history_surface, tap.y * p.history_width + tap.x);
      const vec3 trusts = vec3(
          by_depth != 0 ? soft_trust(depth_difference(here.x, there.x, slope), p.depth_tolerance) : 1.0,
          by_normal != 0 ? soft_trust(distance(normal, unpack_normal(there.zw)), p.normal_tolerance) : 1.0,
          by_id == 0 || here.y == there.y ? 1.0 : 0.0);
      const float area = (i == 0 ? 1.0 - t.x : t.x) * (j == 0 ? 1.0 - t.y : t.y);
      total += area * trusts.x * trusts.y * trusts.z;
      by_rule += area * trusts;
    }
  }
  const float of_flow = by_flow != 0 ? texelFetch(consistency, index).x : 1.0;
  const float of_surface = min(by_rule.x, min(by_rule.y, by_rule.z));
  float rule = of_surface == by_rule.z ? kRejectedById : (of_surface == by_rule.x ? kRejectedByDepth : kRejectedByNormal);
  rule = of_flow < of_surface ? kRejectedByFlow : rule;
  trust.data[index] = vec2(total * of_flow, min(of_surface, of_flow) < 1.0 ? rule : kRejectedByNothing);
}
