// The choice among the 25 shifts of one level. A cost is a patch's sum of distances less the distance of
// equal pixels (lib/distance.glsl); costs are row-major from (-2,-2). The including kernel declares the texel
// buffer `offset_coarse` and the buffers `offset` and `residual` and enables GL_EXT_control_flow_attributes.
#include "lib/distance.glsl"
#include "lib/offset_field.glsl"
#include "lib/quadric.glsl"

/// By how much each further pixel of motion must lower the mean distance. This decides between costs that are
/// equal or differ by rounding alone, so that flat areas stay still instead of drifting.
const float kMotionPenalty = 1e-5;

/// Number of pixels of the patch around `pixel` that lie in the image.
float patch_pixels(ivec2 pixel, ivec2 size, int radius) {
  const ivec2 patch_size = min(pixel + radius, size - 1) - max(pixel - radius, ivec2(0)) + 1;
  return float(patch_size.x * patch_size.y);
}

float pick(float at_minus_one, float at_zero, float at_one, float position) {
  return position < -0.5 ? at_minus_one : position < 0.5 ? at_zero : at_one;
}

/// Subpixel part of the chosen shift, by the quadric through the costs around it. Differs from the paper: the
/// center weight chooses the shift, but the quadric is fitted to unweighted costs, since the minimum of
/// weighted ones is biased (by 0.13 instead of 0.04 px on a random pattern). A minimum on the border of the
/// window has no subpixel part.
vec2 subpixel_part(int kind, float cost[25], vec2 shift, float floor_sum) {
  float around[9];
  [[unroll]] for (int j = 0; j < 3; ++j) {
    float row[5];
    [[unroll]] for (int i = 0; i < 5; ++i) {
      row[i] = pick(cost[5 * j + i], cost[5 * (j + 1) + i], cost[5 * (j + 2) + i], shift.y);
    }
    [[unroll]] for (int i = 0; i < 3; ++i) around[3 * j + i] = pick(row[i], row[i + 1], row[i + 2], shift.x);
  }
  vec2 part;
  quadric_minimum(around[0], around[1], around[2], around[3], around[4], around[5], around[6], around[7], around[8],
                  1e-5 * (floor_sum + around[4]), part.x, part.y);
  const bool squared = kind == kDistanceL2;
  const vec2 limit = vec2(subpixel_limit(around[4], around[3], around[5], squared),
                          subpixel_limit(around[4], around[1], around[7], squared));
  const bool inside = abs(shift.x) < 1.5 && abs(shift.y) < 1.5;
  return inside ? clamp(part, -limit, limit) : vec2(0.0);
}

/// Chooses the shift of least weighted cost and writes the pixel's offset at this level and its residual: the
/// mean cost over the patch, 0 for a perfect match under every distance.
void choose(int kind, float cost[25], ivec2 pixel, ivec2 size, int radius, bool refine, ivec2 coarse_size,
            float coarse_scale) {
  const float pixels = patch_pixels(pixel, size, radius);
  const float floor_sum = pixels * distance_floor(kind);
  const vec2 start = read_offset(pixel, vec2(0.0), coarse_size, coarse_scale);
  // The penalty is for how much a shift lengthens the offset, to second order.
  const float penalty = pixels * kMotionPenalty / (1.0 + length(start));
  float best_cost = 3e38;
  float best = 12.0;
  float best_unweighted = 0.0;
  [[unroll]] for (int k = 0; k < 25; ++k) {
    const vec2 shift = vec2(float(k % 5 - 2), float(k / 5 - 2));
    const float weight = center_weight(kind, shift.x, shift.y);
    const float weighted =
        cost[k] * weight + (floor_sum * (weight - 1.0) + penalty * (dot(start, shift) + 0.5 * dot(shift, shift)));
    const bool better = weighted < best_cost;
    best_cost = better ? weighted : best_cost;
    best_unweighted = better ? cost[k] : best_unweighted;
    best = better ? float(k) : best;
  }
  const float row = floor((best + 0.5) * 0.2);
  vec2 shift = vec2(best - 5.0 * row, row) - 2.0;
  if (refine) shift += subpixel_part(kind, cost, shift, floor_sum);
  // The warped source at the shifted position was read from that position's start, not from this pixel's.
  const vec2 inside = clamp(shift, vec2(-pixel), vec2(size - 1 - pixel));
  const int i = pixel.y * size.x + pixel.x;
  offset.data[i] = shift + read_offset(pixel, inside, coarse_size, coarse_scale);
  residual.data[i] = distance_unit(kind) * max(best_unweighted, 0.0) / pixels;
}
