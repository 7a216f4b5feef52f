// Reads the features of one pyramid level, writes those of the next coarser one: the mean of each factor x factor block.
// Coarse pixel X covers fine pixels [factor X, factor X + factor), so that centres map as fine = factor (X + 0.5) - 0.5
// and no level adds a shift. One invocation a pixel and plane.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/align_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { DownsampleParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer fine;
layout(std430, set = 0, binding = 1) writeonly buffer CoarseBuffer { float data[]; } coarse;

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height) return;
  const ivec2 last = min((at.xy + 1) * p.factor, ivec2(p.width_in, p.height_in));
  float sum = 0.0;
  int count = 0;
  for (int y = at.y * p.factor; y < last.y; ++y) {
    for (int x = at.x * p.factor; x < last.x; ++x) {
      sum += texelFetch(fine, (at.z * p.height_in + y) * p.width_in + x).x;
      ++count;
    }
  }
  coarse.data[(at.z * p.height + at.y) * p.width + at.x] = sum / float(count);
}
