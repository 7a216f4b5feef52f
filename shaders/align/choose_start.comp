// Reads target and source features of one level, the coarser level's offsets and the known motion at full
// resolution; writes the start of the level's search: the motion, averaged over the pixel, where its patch
// matches better, else the coarser offset. The target's first pixel lies at target_origin in the source
// (align/warp_source).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/motion.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int radius = 2;  // of the patches that are compared

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 source_size; ivec2 offset_coarse_size; ivec2 motion_size; ChooseStartParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer target;
layout(set = 0, binding = 1) uniform samplerBuffer source;
layout(set = 0, binding = 2) uniform samplerBuffer offset_coarse;
layout(set = 0, binding = 3) uniform samplerBuffer motion;
layout(set = 0, binding = 4) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 5) writeonly buffer StartBuffer { vec2 data[]; } start;

#include "lib/offset_field.glsl"

/// Sum over the patch of absolute differences of the features at one offset.
float patch_difference(ivec2 at, vec2 offset) {
  const ivec2 origin = ivec2(texelFetch(target_origin, 0).xy) / p.level_px;
  float sum = 0.0;
  for (int plane = 0; plane < p.planes; ++plane) {
    for (int j = -radius; j <= radius; ++j) {
      for (int i = -radius; i <= radius; ++i) {
        const ivec2 q = clamp(at + ivec2(i, j), ivec2(0), size - 1);
        const BilinearTaps taps = bilinear_taps(origin + q, offset, source_size);
        const float there = bilinear_value(source, taps, source_size.x, plane * source_size.y);
        sum += abs(texelFetch(target, (plane * size.y + q.y) * size.x + q.x).x - there);
      }
    }
  }
  return sum;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const vec2 coarse = read_offset(at, vec2(0.0), offset_coarse_size, p.coarse_scale);
  vec2 sum = vec2(0.0);
  float count = 0.0;
  const ivec2 last = min((at + 1) * p.level_px, motion_size);
  for (int y = at.y * p.level_px; y < last.y; ++y) {
    for (int x = at.x * p.level_px; x < last.x; ++x) {
      const vec2 m = texelFetch(motion, y * motion_size.x + x).xy;
      const bool known = is_known_motion(m.x, m.y);
      sum += known ? m : vec2(0.0);
      count += known ? 1.0 : 0.0;
    }
  }
  const vec2 known = count > 0.0 ? sum / (count * float(p.level_px)) : coarse;
  start.data[at.y * size.x + at.x] = patch_difference(at, known) < patch_difference(at, coarse) ? known : coarse;
}
