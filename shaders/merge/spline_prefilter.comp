// Reads the history's colour, writes along one direction the coefficients of the spline through it; two passes make those
// of the image (lib/resample.glsl has the spline and its prefilter).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "lib/resample.glsl"

layout(constant_id = 0) const int radius = 8;
layout(constant_id = 1) const int along_y = 0;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer values;
layout(std430, set = 0, binding = 1) writeonly buffer CoefficientBuffer { vec4 data[]; } coefficients;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const int position = along_y != 0 ? at.y : at.x;
  const int last = (along_y != 0 ? p.height : p.width) - 1;
  const int stride = along_y != 0 ? p.width : 1;
  vec4 sum = texelFetch(values, index);
  float weight = 1.0;
  float weights = 1.0;
  [[unroll]] for (int i = 1; i <= radius; ++i) {
    weight *= kOMomsPole;
    weights += 2.0 * weight;
    sum += weight * (texelFetch(values, index + (max(position - i, 0) - position) * stride) +
                     texelFetch(values, index + (min(position + i, last) - position) * stride));
  }
  coefficients.data[index] = sum / weights;
}
