// Reads the offsets and the surfaces (normal, depth) and object numbers of the new frame and of the last one;
// writes 1 where the history may be of the same surface, else 0: where one of 3x3 pixels about the place has
// the object, a similar depth and a similar normal (survey of Yang et al. 2020, section 4.1), and keeps the
// surfaces for the next frame. Jitter moves edges by up to a pixel of the samples, `reach` of these, which is
// why neighbours count; what leaks across an edge is left to rectification. What a frame does not have is 0 in
// both and alike.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int reach = 1;  // pixels between the 3x3 that are looked at

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer surface;
layout(set = 0, binding = 2) uniform samplerBuffer object;
layout(set = 0, binding = 3) uniform samplerBuffer last_surface;
layout(set = 0, binding = 4) uniform samplerBuffer last_object;
layout(std430, set = 0, binding = 5) writeonly buffer ValidBuffer { float data[]; } valid;
layout(std430, set = 0, binding = 6) writeonly buffer NextSurfaceBuffer { vec4 data[]; } next_surface;
layout(std430, set = 0, binding = 7) writeonly buffer NextObjectBuffer { float data[]; } next_object;

const float kDepthTolerance = 0.1;  // relative; an approach of 5 % a frame is fast
const float kLeastCosine = 0.7;

bool is_alike(vec4 a, vec4 b) {
  const bool same_depth = abs(a.w - b.w) <= kDepthTolerance * max(a.w, b.w);
  const float lengths = sqrt(dot(a.xyz, a.xyz) * dot(b.xyz, b.xyz));
  return same_depth && dot(a.xyz, b.xyz) >= kLeastCosine * lengths;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const ivec2 middle = at + ivec2(round(clamp(texelFetch(offset, index).xy, -1e6, 1e6)));
  const vec4 here = texelFetch(surface, index);
  const float number = texelFetch(object, index).x;
  bool found = false;
  [[unroll]] for (int k = 0; k < 9; ++k) {
    const ivec2 q = clamp(middle + reach * (ivec2(k % 3, k / 3) - 1), ivec2(0), size - 1);
    const int tap = q.y * size.x + q.x;
    found = found || (texelFetch(last_object, tap).x == number && is_alike(here, texelFetch(last_surface, tap)));
  }
  valid.data[index] = found ? 1.0 : 0.0;
  next_surface.data[index] = here;
  next_object.data[index] = number;
}
