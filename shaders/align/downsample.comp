// Reads the features of one pyramid level, writes those of the next coarser one: the mean of each factor x factor block.
// Coarse pixel X covers fine pixels [factor X, factor X + factor), so that centres map as fine = factor (X + 0.5) - 0.5
// and no level adds a shift. One invocation a pixel and plane.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/block_mean.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int factor = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { DownsampleParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer fine;
layout(std430, set = 0, binding = 1) writeonly buffer CoarseBuffer { float data[]; } coarse;

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height) return;
  coarse.data[(at.z * p.height + at.y) * p.width + at.x] =
      block_mean(fine, at.xy, at.z, ivec2(p.width_in, p.height_in), factor);
}
