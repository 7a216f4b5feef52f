// Reads an image of patch statistics, writes its box sums along one direction; two passes sum a square patch. The second
// may leave out the pixel's own row: variance_gain adds what belongs to the patch of it, so that the pixel itself is never
// part of its sums (taking it out again would leave the rounding of a firefly's square). Patches are small (radius 1 to
// 8), so each sum is taken anew and no rounding residue travels along a row.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/merge_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { BoxParams p; };
layout(std430, set = 0, binding = 0) readonly buffer StatisticsBuffer { vec4 data[]; } statistics;
layout(std430, set = 0, binding = 1) writeonly buffer SumBuffer { vec4 data[]; } sums;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  vec4 sum = vec4(0.0);
  for (int y = max(at.y - p.radius_y, 0); y <= min(at.y + p.radius_y, p.height - 1); ++y) {
    if (p.without_own_row != 0 && y == at.y) continue;
    for (int x = max(at.x - p.radius_x, 0); x <= min(at.x + p.radius_x, p.width - 1); ++x) {
      sum += statistics.data[y * p.width + x];
    }
  }
  sums.data[at.y * p.width + at.x] = sum;
}
