// Reads the offsets of one level; writes the median of each component over 3x3 pixels. A level measures its
// shift over a patch whose pixels each start from their own offset, so the noise of a single pixel's start
// passes into its result. The median removes that noise and keeps motion borders (Sun et al. 2010, "Secrets
// of optical flow estimation and their principles", find the same for the warping steps of optical flow).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer offset_noisy;
layout(std430, set = 0, binding = 1) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

void sort(inout vec2 a, inout vec2 b) {
  const vec2 lower = min(a, b);
  b = max(a, b);
  a = lower;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  vec2 v[9];
  [[unroll]] for (int j = 0; j < 3; ++j) {
    [[unroll]] for (int i = 0; i < 3; ++i) {
      const ivec2 tap = clamp(at + ivec2(i, j) - 1, ivec2(0), size - 1);
      v[3 * j + i] = texelFetch(offset_noisy, tap.y * size.x + tap.x).xy;
    }
  }
  // Sort the columns of a 3x3 square, then its rows; the median lies on the other diagonal.
  [[unroll]] for (int pass = 0; pass < 2; ++pass) {
    const int step = pass == 0 ? 3 : 1;
    const int next = pass == 0 ? 1 : 3;
    [[unroll]] for (int line = 0; line < 3; ++line) {
      const int first = line * next;
      sort(v[first], v[first + step]);
      sort(v[first + step], v[first + 2 * step]);
      sort(v[first], v[first + step]);
    }
  }
  sort(v[2], v[4]);
  sort(v[4], v[6]);
  sort(v[2], v[4]);
  offset.data[at.y * size.x + at.x] = v[4];
}
