// A 3x3 convolution, or the first part of one: reads `planes` planes of the source, which has the result's
// size, and the pass's weights; writes for each channel and pixel of the result a bias plus the weighted sum
// of the 3x3 pixels around, rectified if `rectify` is set. An invocation makes 2 pixels of a row in 2 planes:
// dispatch {ceil(width / 2), height, planes of the result / 2}.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/convolve_params.h"

layout(push_constant) uniform Params { ivec2 result_size; ConvolveParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer source;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(std430, set = 0, binding = 2) writeonly buffer ResultBuffer { vec4 data[]; } result;

#include "lib/convolve.glsl"

void main() {
  load_weights();
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) * ivec2(kBlock, 1);
  [[unroll]] for (int i = 0; i < kPlanesMade * kBlock; ++i) sums[i] = shared_weights[i / kBlock];
  convolve(at);
  [[unroll]] for (int i = 0; i < kPlanesMade * kBlock; ++i) {
    const int x = at.x + i % kBlock;
    const int plane = first_output() + i / kBlock;
    if (x < result_size.x && at.y < result_size.y) result.data[(plane * result_size.y + at.y) * result_size.x + x] = finished(sums[i]);
  }
}
