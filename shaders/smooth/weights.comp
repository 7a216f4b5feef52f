// Reads luminance and variance; writes the weights of all pixels of the window around each: non-local means with the
// variance known (Rousselle et al. 2012, "Adaptive rendering with non-local means filtering", eq. 3 and 4), over patches. An
// invocation makes a column of `rows` pixels, whose patches share the sums of their rows, for the shifts of one plane.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/gain.glsl"
#include "lib/patch_weights.glsl"
#include "shared/smooth_params.h"

layout(constant_id = 0) const int radius = 5;        // of the window
layout(constant_id = 1) const int patch_radius = 3;  // 1 to 3
const int rows = 16;

layout(local_size_x = 8, local_size_y = 1) in;
layout(push_constant) uniform Params { SmoothParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer guide;
layout(std430, set = 0, binding = 1) writeonly buffer WeightBuffer { uint data[]; } weights;

/// How many times noisier than a pixel others may be for their noise to count in full: whatever is noisy enough could be
/// like it, and would only spoil it.
const float kLargestNoiseRatio = 10.0;

/// How far one pixel may take a patch from another, as an exponent. A lone bright sample makes all the patches that it is in
/// unlike any other, and nothing would smooth it; this leaves it to the many of the window. What goes through a patch has
/// three such pixels and more. A point of light that is known by `kCertain` times as much stays, and so does what is so much
/// brighter that a hundredth of it would show.
const float kLargestShareOfPixel = 4.0;
const float kCertain = 8.0;

/// Squared difference that noise does not explain, over the noise that is allowed, as a, the pixel to be smoothed, sees b.
float distance_of(vec2 a, vec2 b) {
  const float d = a.x - b.x;
  const float l = 0.5 * (a.x + b.x);
  const float allowed = a.y + min(b.y, kLargestNoiseRatio * a.y);
  return (d * d - (a.y + min(a.y, b.y))) / (p.strength * p.strength * allowed + 3e-3 * (l * l + 1e-3));
}

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  const int first = at.y * rows;
  if (at.x >= p.width || first >= p.height) return;
  const int shifts = (2 * radius + 1) * (2 * radius + 1);
  const int side = 2 * patch_radius + 1;
  const float largest = kLargestShareOfPixel * float(side * side);
  uint packed[rows];
  [[unroll]] for (int r = 0; r < rows; ++r) packed[r] = 0u;
  for (int i = 0; i < kShiftsPerPlane; ++i) {
    const int number = at.z * kShiftsPerPlane + i;
    const ivec2 shift = window_shift(number, radius);
    float sums[rows];
    [[unroll]] for (int r = 0; r < rows; ++r) sums[r] = 0.0;
    [[unroll]] for (int r = -patch_radius; r < rows + patch_radius; ++r) {
      const int here = clamp(first + r, 0, p.height - 1) * p.width;
      const int there = clamp(first + r + shift.y, 0, p.height - 1) * p.width;
      float sum = 0.0;
      [[unroll]] for (int c = -patch_radius; c <= patch_radius; ++c) {
        const vec2 a = texelFetch(guide, here + clamp(at.x + c, 0, p.width - 1)).xy;
        const vec2 b = texelFetch(guide, there + clamp(at.x + c + shift.x, 0, p.width - 1)).xy;
        const float distance = distance_of(a, b);
        const bool may_be_noise = abs(a.x - b.x) < kLargestBorrowedNoise;
        sum += may_be_noise ? min(distance, max(largest, distance / kCertain)) : distance;
      }
      [[unroll]] for (int o = 0; o < rows; ++o) {
        if (abs(r - o) <= patch_radius) sums[o] += sum;
      }
    }
    const bool inside_x = at.x + shift.x >= 0 && at.x + shift.x < p.width && number < shifts;
    [[unroll]] for (int r = 0; r < rows; ++r) {
      const int y = first + r + shift.y;
      const bool inside = inside_x && y >= 0 && y < p.height;
      const float weight = exp(-max(sums[r] / float(side * side), 0.0));
      packed[r] |= inside ? uint(255.0 * weight + 0.5) << (8 * i) : 0u;
    }
  }
  [[unroll]] for (int r = 0; r < rows; ++r) {
    if (first + r < p.height) weights.data[(at.z * p.height + first + r) * p.width + at.x] = packed[r];
  }
}
