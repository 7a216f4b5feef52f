// Reads the features of one pyramid level, writes those of the next coarser one: the mean of each factor x factor block.
// Coarse pixel X covers fine pixels [factor X, factor X + factor), so that centres map as fine = factor (X + 0.5) - 0.5
// and no level adds a shift. One invocation a pixel and plane.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/block_mean.glsl"

layout(constant_id = 0) const int factor = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 fine_size; };
layout(set = 0, binding = 0) uniform samplerBuffer fine;
layout(std430, set = 0, binding = 1) writeonly buffer CoarseBuffer { float data[]; } coarse;

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= size.x || at.y >= size.y) return;
  coarse.data[(at.z * size.y + at.y) * size.x + at.x] =
      block_mean(fine, at.xy, at.z, fine_size, factor);
}
