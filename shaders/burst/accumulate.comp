// Reads the reference's samples, a frame's at their places, their differences and the column sums of these, and
// what was accumulated before; adds the frame's samples with their weights: (weighted sum, sum of weights).
// Green samples are weighed by green differences, red and blue by theirs: these have fewer samples and err more.
// A sample that is saturated in the reference stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "lib/mosaic.glsl"

layout(constant_id = 0) const int radius = 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer reference;
layout(set = 0, binding = 1) uniform samplerBuffer warped;
layout(set = 0, binding = 2) uniform samplerBuffer difference;
layout(set = 0, binding = 3) uniform samplerBuffer sums;
layout(set = 0, binding = 4) uniform samplerBuffer levels;
layout(set = 0, binding = 5) uniform samplerBuffer before;
layout(std430, set = 0, binding = 6) writeonly buffer AfterBuffer { vec2 data[]; } after;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const float kind = texelFetch(difference, index).y;
  const int plane = kind < 0.0 ? size.x * size.y : 0;
  vec4 patch_sums = vec4(0.0);
  [[unroll]] for (int x = -radius; x <= radius; ++x) {
    const bool inside = at.x + x >= 0 && at.x + x < size.x;
    patch_sums += inside ? texelFetch(sums, plane + (inside ? index + x : index)) : vec4(0.0);
  }
  const float x = texelFetch(reference, index).x;
  const vec2 h = texelFetch(warped, index).xy;
  const float signal = 0.5 * (x + h.x);
  const float own = noise_variance(texelFetch(levels, kReferenceNoise).x, texelFetch(levels, kReferenceNoise + 1).x, signal);
  const float other = h.y * noise_variance(texelFetch(levels, kFrameNoise).x, texelFetch(levels, kFrameNoise + 1).x, signal);
  const float w = kind != 0.0 ? frame_weight(patch_sums.x, patch_sums.y, patch_sums.z, own, other) : 0.0;
  after.data[index] = texelFetch(before, index).xy + vec2(w * h.x, w);
}
