// Reads two candidates of each pixel's offset into the other eye's image, the one that follows from its depth
// and the one that a search found, features of both eyes and the other eye's depth; writes the offset. The
// depth's is exact on surfaces, the search's finds what surfaces reflect or refract; the search's is taken
// where its patch differs less by far. Where the other eye sees neither (the depth there is not the one that
// is expected: another surface hides the pixel's), the offset leads out of every image.
// The candidates are (search x, y; x of the depth's, kNoMotion if not known; expected depth, 0 if not known).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/bilinear.glsl"
#include "lib/language.glsl"
#include "lib/stereo.glsl"

layout(constant_id = 0) const int has_depth = 0;  // 1: frames have depth

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 other_size; };
layout(set = 0, binding = 0) uniform samplerBuffer candidates;
layout(set = 0, binding = 1) uniform samplerBuffer own;
layout(set = 0, binding = 2) uniform samplerBuffer other;
layout(set = 0, binding = 3) uniform samplerBuffer other_depth;
layout(set = 0, binding = 4) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 5) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

const int kRadius = 1;

/// Sum over the patch of absolute differences at one offset.
float patch_difference(ivec2 at, ivec2 origin, vec2 by) {
  float sum = 0.0;
  [[unroll]] for (int j = -kRadius; j <= kRadius; ++j) {
    [[unroll]] for (int i = -kRadius; i <= kRadius; ++i) {
      const ivec2 q = clamp(at + ivec2(i, j), ivec2(0), size - 1);
      const BilinearTaps taps = bilinear_taps(origin + q, by, other_size);
      const int top = taps.lo.y * other_size.x;
      const int bottom = taps.hi.y * other_size.x;
      const float there = mix(mix(texelFetch(other, top + taps.lo.x).x, texelFetch(other, top + taps.hi.x).x, taps.t.x),
                              mix(texelFetch(other, bottom + taps.lo.x).x, texelFetch(other, bottom + taps.hi.x).x, taps.t.x), taps.t.y);
      sum += abs(texelFetch(own, q.y * size.x + q.x).x - there);
    }
  }
  return sum;
}

/// Whether one of the pixels around the position has the expected depth.
bool has_expected_depth(ivec2 at, ivec2 origin, vec2 by, float expected) {
  const BilinearTaps taps = bilinear_taps(origin + at, by, other_size);
  bool found = false;
  [[unroll]] for (int j = 0; j < 2; ++j) {
    [[unroll]] for (int i = 0; i < 2; ++i) {
      const int y = j == 0 ? taps.lo.y : taps.hi.y;
      const int x = i == 0 ? taps.lo.x : taps.hi.x;
      found = found || is_expected_depth(texelFetch(other_depth, y * other_size.x + x).x, expected);
    }
  }
  return found;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const ivec2 origin = ivec2(texelFetch(target_origin, 0).xy);
  const vec4 given = texelFetch(candidates, index);
  vec2 chosen = given.xy;
  if (has_depth != 0) {
    const bool known = abs(given.z) < kFarOffset;
    const vec2 of_depth = vec2(known ? given.z : 0.0, 0.0);
    const bool search_wins = patch_difference(at, origin, given.xy) < kSearchWins * patch_difference(at, origin, of_depth);
    chosen = known && !search_wins ? of_depth : chosen;
  }
  if (has_depth != 0 && given.w > 0.0) chosen = has_expected_depth(at, origin, chosen, given.w) ? chosen : vec2(kFarOffset);
  offset.data[index] = chosen;
}
