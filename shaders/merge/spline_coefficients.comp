// Reads an image; writes the coefficients along one direction of the cubic B-spline that passes through its
// pixels (cardinal spline); two passes serve both directions. The recursive filter of Unser (1999) is cut
// off at kSplineReach, where its response, which falls by 0.268 a pixel, is below 1e-4. The border repeats.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/limits.h"

layout(constant_id = 0) const int along_y = 0;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; int first_row; };
layout(set = 0, binding = 0) uniform samplerBuffer image;
layout(std430, set = 0, binding = 1) writeonly buffer CoefficientsBuffer { vec4 data[]; } coefficients;

const float kPole = -0.26794919;  // sqrt(3) - 2

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const int position = along_y != 0 ? at.y : at.x;
  const int last = (along_y != 0 ? size.y : size.x) - 1;
  const int stride = along_y != 0 ? size.x : 1;
  const vec4 here = texelFetch(image, index);
  // Differences from the pixel: an even image is its own coefficients, bit for bit.
  vec4 sum = vec4(0.0);
  float power = 1.0;
  float weights = 1.0;
  [[unroll]] for (int i = 1; i <= kSplineReach; ++i) {
    power *= kPole;
    weights += 2.0 * power;
    sum += power * (texelFetch(image, index + (max(position - i, 0) - position) * stride) - here);
    sum += power * (texelFetch(image, index + (min(position + i, last) - position) * stride) - here);
  }
  coefficients.data[index - first_row * size.x] = here + sum / weights;
}
