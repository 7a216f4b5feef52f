// A further part of a 3x3 convolution: reads and writes as smooth/convolve does, but adds to what earlier
// parts left in the result. It rectifies, if `rectify` is set, after adding.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/convolve_params.h"

layout(push_constant) uniform Params { ivec2 result_size; ConvolveParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer source;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(std430, set = 0, binding = 2) buffer ResultBuffer { vec4 data[]; } result;

#include "lib/convolve.glsl"

void main() {
  load_weights();
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) * ivec2(kBlock, 1);
  [[unroll]] for (int i = 0; i < kPlanesMade * kBlock; ++i) sums[i] = shared_weights[i / kBlock];
  convolve(at);
  [[unroll]] for (int i = 0; i < kPlanesMade * kBlock; ++i) {
    const int x = at.x + i % kBlock;
    const int index = ((first_output() + i / kBlock) * result_size.y + at.y) * result_size.x + x;
    if (x < result_size.x && at.y < result_size.y) result.data[index] = finished(result.data[index] + sums[i]);
  }
}
