// Reads planes of guide images (albedo, normal), writes them as planes of matching features: weighted and averaged over
// downsample x downsample pixels. One invocation a pixel and plane.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/block_mean.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int downsample = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 guide_size; GuideFeatureParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer guide;
layout(std430, set = 0, binding = 1) writeonly buffer FeaturesBuffer { float data[]; } features;

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= size.x || at.y >= size.y) return;
  features.data[((p.plane + at.z) * size.y + at.y) * size.x + at.x] =
      p.weight * block_mean(guide, at.xy, p.plane + at.z, guide_size, downsample);
}
