// Reads target and source features of one level, the coarser level's offsets and the known motion at full
// resolution; writes the start of the level's search: the motion, averaged over the pixel, where its patch
// matches better, else the coarser offset. The target's first pixel lies at target_origin in the source
// (align/warp_source).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/motion.glsl"
#include "shared/align_params.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ChooseStartParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer target;
layout(set = 0, binding = 1) uniform samplerBuffer source;
layout(set = 0, binding = 2) uniform samplerBuffer offset_coarse;
layout(set = 0, binding = 3) uniform samplerBuffer motion;
layout(set = 0, binding = 4) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 5) writeonly buffer StartBuffer { vec2 data[]; } start;

#include "lib/offset_field.glsl"

const int kRadius = 2;

/// Sum over the patch of absolute differences of the features at one offset.
float patch_difference(ivec2 at, vec2 offset) {
  const ivec2 origin = ivec2(texelFetch(target_origin, 0).xy) / p.level_px;
  float sum = 0.0;
  for (int plane = 0; plane < p.planes; ++plane) {
    for (int j = -kRadius; j <= kRadius; ++j) {
      for (int i = -kRadius; i <= kRadius; ++i) {
        const ivec2 q = clamp(at + ivec2(i, j), ivec2(0), ivec2(p.width, p.height) - 1);
        const BilinearTaps taps = bilinear_taps(origin + q, offset, ivec2(p.source_width, p.source_height));
        const int top = (plane * p.source_height + taps.lo.y) * p.source_width;
        const int bottom = (plane * p.source_height + taps.hi.y) * p.source_width;
        const float there =
            mix(mix(texelFetch(source, top + taps.lo.x).x, texelFetch(source, top + taps.hi.x).x, taps.t.x),
                mix(texelFetch(source, bottom + taps.lo.x).x, texelFetch(source, bottom + taps.hi.x).x, taps.t.x), taps.t.y);
        sum += abs(texelFetch(target, (plane * p.height + q.y) * p.width + q.x).x - there);
      }
    }
  }
  return sum;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const vec2 coarse = read_offset(at, vec2(0.0), ivec2(p.coarse_width, p.coarse_height), p.coarse_scale);
  vec2 sum = vec2(0.0);
  float count = 0.0;
  const ivec2 last = min((at + 1) * p.level_px, ivec2(p.full_width, p.full_height));
  for (int y = at.y * p.level_px; y < last.y; ++y) {
    for (int x = at.x * p.level_px; x < last.x; ++x) {
      const vec2 m = texelFetch(motion, y * p.full_width + x).xy;
      const bool known = is_known_motion(m.x, m.y);
      sum += known ? m : vec2(0.0);
      count += known ? 1.0 : 0.0;
    }
  }
  const vec2 known = count > 0.0 ? sum / (count * float(p.level_px)) : coarse;
  start.data[at.y * p.width + at.x] = patch_difference(at, known) < patch_difference(at, coarse) ? known : coarse;
}
