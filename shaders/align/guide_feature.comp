// Reads planes of guide images (albedo, normal), writes them as planes of matching features: weighted and averaged over
// downsample x downsample pixels. One invocation a pixel and plane.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/align_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { GuideFeatureParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer guide;
layout(std430, set = 0, binding = 1) writeonly buffer FeaturesBuffer { float data[]; } features;

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height || at.z >= p.planes) return;
  const ivec2 last = min((at.xy + 1) * p.downsample, ivec2(p.width_in, p.height_in));
  float sum = 0.0;
  int count = 0;
  for (int y = at.y * p.downsample; y < last.y; ++y) {
    for (int x = at.x * p.downsample; x < last.x; ++x) {
      sum += texelFetch(guide, ((p.plane_in + at.z) * p.height_in + y) * p.width_in + x).x;
      ++count;
    }
  }
  features.data[((p.plane + at.z) * p.height + at.y) * p.width + at.x] = p.weight * sum / float(count);
}
