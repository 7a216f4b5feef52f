// Reads a frame that came without variance and without albedo; writes an estimate of each pixel's variance:
// the squared second difference along both axes, [1 -2 1] by [1 -2 1] (Immerkaer 1996), over the variance
// that unit noise gives it. It vanishes for any sum of a function of x and a function of y, such as gradients
// and edges along an axis, and is small for most other detail. Without features that explain texture, only
// the highest frequency tells noise from it.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "shared/limits.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer valid;
layout(std430, set = 0, binding = 2) writeonly buffer VarianceBuffer { vec2 data[]; } variance;

/// Coefficients of the difference along an axis, over three pixels or as many as the image has.
float coefficient(int tap, int size) {
  if (size == 1) return tap == 0 ? 1.0 : 0.0;
  if (size == 2) return tap == 2 ? 0.0 : 1.0 - 2.0 * float(tap);
  return tap == 1 ? -2.0 : 1.0;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const ivec2 first = clamp(at - 1, ivec2(0), max(size - 3, 0));
  vec3 difference = vec3(0.0);
  float noise = 0.0;  // the difference's variance if each pixel has unit variance
  [[unroll]] for (int t = 0; t < 9; ++t) {
    const ivec2 tap = ivec2(t % 3, t / 3);
    const float c = coefficient(tap.x, size.x) * coefficient(tap.y, size.y);
    const ivec2 from = min(first + tap, size - 1);
    difference += c * texelFetch(color, from.y * size.x + from.x).rgb;
    noise += c * c;
  }
  // Scaled before squaring: the square of the difference alone may exceed the range of floats.
  const vec3 deviation = clamp(difference * inversesqrt(3.0 * noise), -vec3(1e18), vec3(1e18));
  const int index = at.y * size.x + at.x;
  variance.data[index] = vec2(min(dot(deviation, deviation), kLargestVariance), texelFetch(valid, index).y);
}
