// Reads the patch statistics, writes their box sums along one direction; two passes sum a square patch. One invocation
// a pixel and plane. Patches are small (radius 1 to 8), so each sum is taken anew: no rounding residue of a firefly
// travels along a row.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/merge_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { BoxParams p; };
layout(std430, set = 0, binding = 0) readonly buffer StatisticsBuffer { vec4 data[]; } statistics;
layout(std430, set = 0, binding = 1) writeonly buffer SumBuffer { vec4 data[]; } sums;

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height || at.z >= p.planes) return;
  const int plane = at.z * p.width * p.height;
  vec4 sum = vec4(0.0);
  for (int y = max(at.y - p.radius_y, 0); y <= min(at.y + p.radius_y, p.height - 1); ++y) {
    for (int x = max(at.x - p.radius_x, 0); x <= min(at.x + p.radius_x, p.width - 1); ++x) {
      sum += statistics.data[plane + y * p.width + x];
    }
  }
  sums.data[plane + at.y * p.width + at.x] = sum;
}
