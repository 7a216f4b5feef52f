// Reads a frame's three colours and the offsets of blocks; writes for each sample of the reference its colour
// at the place that the offset leads to, by Catmull-Rom, and the ratio of that value's variance to a sample's:
// (value, ratio), or (0, 0) where the place is outside of the frame or next to a saturated sample.
// `target_origin` is the place of the reference's first pixel in the frame's images, `target_place` that in the
// pattern.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/mosaic.glsl"
#include "lib/resample.glsl"

layout(constant_id = 0) const int period = 2;
layout(constant_id = 1) const int block = 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 green_size; ivec2 offset_size; };
layout(set = 0, binding = 0) uniform samplerBuffer red;
layout(set = 0, binding = 1) uniform samplerBuffer green;
layout(set = 0, binding = 2) uniform samplerBuffer blue;
layout(set = 0, binding = 3) uniform samplerBuffer offset;
layout(set = 0, binding = 4) uniform samplerBuffer colors;
layout(set = 0, binding = 5) uniform samplerBuffer levels;
layout(set = 0, binding = 6) uniform samplerBuffer target_place;
layout(set = 0, binding = 7) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 8) writeonly buffer WarpedBuffer { vec2 data[]; } warped;

/// Share of a sample's variance that its interpolation from others keeps, at least: their noise is not
/// independent.
const float kLeastRatio = 0.35;

/// The offset of a pixel, between those of the centres of blocks.
vec2 offset_at(ivec2 at) {
  const ivec2 inside = at % block;
  const vec2 from_centre = (vec2(inside) + 0.5) / float(block) - 0.5;
  const vec2 base = floor(from_centre);
  const vec2 t = from_centre - base;
  const ivec2 lo = clamp(at / block + ivec2(base), ivec2(0), offset_size - 1);
  const ivec2 hi = clamp(at / block + ivec2(base) + 1, ivec2(0), offset_size - 1);
  return mix(mix(texelFetch(offset, lo.y * offset_size.x + lo.x).xy, texelFetch(offset, lo.y * offset_size.x + hi.x).xy, t.x),
             mix(texelFetch(offset, hi.y * offset_size.x + lo.x).xy, texelFetch(offset, hi.y * offset_size.x + hi.x).xy, t.x), t.y);
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const ivec2 phase = (at + ivec2(texelFetch(target_place, 0).xy)) % period;
  const float color = texelFetch(colors, phase.y * period + phase.x).x;
  const float saturated = texelFetch(levels, kFrameSaturated).x;
  const vec2 displacement = float(block) * offset_at(at);
  const vec2 base = floor(displacement);
  const vec2 t = displacement - base;
  const ivec2 corner = at + ivec2(texelFetch(target_origin, 0).xy) + ivec2(base) - 1;
  const bool inside = all(greaterThanEqual(vec2(corner + 1) + t, vec2(0.0))) &&
                      all(lessThanEqual(vec2(corner + 1) + t, vec2(green_size - 1)));
  float wx[4];
  float wy[4];
  catmull_rom(t.x, wx[0], wx[1], wx[2], wx[3]);
  catmull_rom(t.y, wy[0], wy[1], wy[2], wy[3]);
  float sum = 0.0;
  float largest = -3.4e38;
  [[unroll]] for (int j = 0; j < 4; ++j) {
    const int row = clamp(corner.y + j, 0, green_size.y - 1) * green_size.x;
    [[unroll]] for (int i = 0; i < 4; ++i) {
      const int tap = row + clamp(corner.x + i, 0, green_size.x - 1);
      const float g = texelFetch(green, tap).x;
      float value = g;
      if (color == 0.0) value = texelFetch(red, tap).x;
      if (color == 2.0) value = texelFetch(blue, tap).x;
      const float w = wx[i] * wy[j];
      sum += w * value;
      largest = w != 0.0 ? max(largest, max(value, g)) : largest;
    }
  }
  const float rows = wx[0] * wx[0] + wx[1] * wx[1] + wx[2] * wx[2] + wx[3] * wx[3];
  const float columns = wy[0] * wy[0] + wy[1] * wy[1] + wy[2] * wy[2] + wy[3] * wy[3];
  const bool usable = inside && largest < saturated;
  warped.data[at.y * size.x + at.x] = usable ? vec2(sum, max(rows * columns, kLeastRatio)) : vec2(0.0);
}
