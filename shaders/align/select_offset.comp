// Reads the 25 patch-distance images of a band and the coarser level's offsets; writes each pixel's total offset at this
// level and its residual patch distance: the mean over the patch, less the distance of equal pixels, so that 0 is a
// perfect match under every distance. Equal costs prefer the smaller total motion, so flat areas stay still.
// Differs from the paper: the center weight chooses the shift, but the quadric is fitted to the distances without it,
// since their weighted minimum lies nearer to the coarser level's offset (README.md has the figures).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/distance.glsl"
#include "lib/quadric.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int kind = kDistanceLogL1Centered;

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { SelectParams p; };
layout(std430, set = 0, binding = 0) readonly buffer SumBuffer { float data[]; } sums;
layout(std430, set = 0, binding = 1) readonly buffer CoarseBuffer { vec2 data[]; } offset_coarse;
layout(std430, set = 0, binding = 2) writeonly buffer OffsetBuffer { vec2 data[]; } offset;
layout(std430, set = 0, binding = 3) writeonly buffer ResidualBuffer { float data[]; } residual;

#include "lib/offset_field.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.rows) return;
  const int row = p.first_row + at.y;
  const int patch_width = min(at.x + p.radius, p.width - 1) - max(at.x - p.radius, 0) + 1;
  const int patch_height = min(row + p.radius, p.height - 1) - max(row - p.radius, 0) + 1;
  const float patch_pixels = float(patch_width * patch_height);
  const vec2 coarse = read_offset(ivec2(at.x, row), ivec2(p.coarse_width, p.coarse_height), p.coarse_scale);

  float sum[25];
  int best = 0;
  float best_cost = 0.0;
  float best_motion = 0.0;
  for (int k = 0; k < 25; ++k) {
    const vec2 s = vec2(k % 5 - 2, k / 5 - 2);
    sum[k] = sums.data[(k * p.rows + at.y) * p.width + at.x];
    const float cost = sum[k] * center_weight(kind, s.x, s.y);
    const vec2 total = coarse + s;
    const float motion = dot(total, total);
    if (k == 0 || cost < best_cost || (cost == best_cost && motion < best_motion)) {
      best = k;
      best_cost = cost;
      best_motion = motion;
    }
  }
  const ivec2 s = ivec2(best % 5 - 2, best / 5 - 2);
  vec2 subpixel = vec2(0.0);
  // A minimum on the border of the window has no quadric around it.
  if (p.refine != 0 && abs(s.x) < 2 && abs(s.y) < 2) {
    quadric_minimum(sum[best - 6], sum[best - 5], sum[best - 4], sum[best - 1], sum[best], sum[best + 1],
                    sum[best + 4], sum[best + 5], sum[best + 6], subpixel.x, subpixel.y);
    const float least = patch_pixels * distance_floor(kind);
    const bool squared = kind == kDistanceL2;
    const vec2 limit = vec2(subpixel_limit(sum[best], sum[best - 1], sum[best + 1], least, squared),
                            subpixel_limit(sum[best], sum[best - 5], sum[best + 5], least, squared));
    subpixel = clamp(subpixel, -limit, limit);
  }
  offset.data[row * p.width + at.x] = coarse + vec2(s) + subpixel;
  residual.data[row * p.width + at.x] =
      sum[best] / patch_pixels - distance_floor(kind);
}
