// Reads a frame's mosaic and the offsets of blocks; writes for each sample of the reference its colour at the
// place that the offset leads to, a weighted sum of the samples around it (filter/burst/cfa_weights.h), and the
// ratio of that value's variance to a sample's: (value, ratio), or (0, 0) where the place is outside of the
// frame or next to a saturated sample. `target_place` is the place of the reference's first pixel in the
// pattern, `source_place` that of the frame's, and `target_origin` the place of the reference's first pixel in
// the frame's image.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/mosaic.glsl"

layout(constant_id = 0) const int period = 2;
layout(constant_id = 1) const int block = 2;
layout(constant_id = 2) const int taps = 6;
layout(constant_id = 3) const int before = 2;
layout(constant_id = 4) const int steps = 16;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 mosaic_size; ivec2 offset_size; };
layout(set = 0, binding = 0) uniform samplerBuffer mosaic;
layout(set = 0, binding = 1) uniform samplerBuffer offset;
layout(set = 0, binding = 2) uniform samplerBuffer colors;
layout(set = 0, binding = 3) uniform samplerBuffer weights;
layout(set = 0, binding = 4) uniform samplerBuffer levels;
layout(set = 0, binding = 5) uniform samplerBuffer target_place;
layout(set = 0, binding = 6) uniform samplerBuffer source_place;
layout(set = 0, binding = 7) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 8) writeonly buffer WarpedBuffer { vec2 data[]; } warped;

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
  const int index = at.y * size.x + at.x;
  const ivec2 displacement = ivec2(floor(float(block * steps) * offset_at(at) + 0.5));
  const ivec2 place = steps * (at + ivec2(texelFetch(target_origin, 0).xy)) + displacement;
  if (any(lessThan(place, ivec2(0))) || any(greaterThan(place, steps * (mosaic_size - 1)))) {
    warped.data[index] = vec2(0.0);
    return;
  }
  const ivec2 corner = place / steps;
  const ivec2 target_phase = (at + ivec2(texelFetch(target_place, 0).xy)) % period;
  const ivec2 source_phase = (corner + ivec2(texelFetch(source_place, 0).xy)) % period;
  const int color = int(texelFetch(colors, target_phase.y * period + target_phase.x).x);
  const ivec2 within = place % steps;
  int tap = ((source_phase.y * period + source_phase.x) * steps * steps + within.y * steps + within.x) * 3 + color;
  tap *= taps * taps;
  int column[taps];
  [[unroll]] for (int i = 0; i < taps; ++i) column[i] = mirrored(corner.x + i - before, mosaic_size.x, period);
  float sum = 0.0;
  float ratio = 0.0;
  float largest = -3.4e38;
  [[unroll]] for (int j = 0; j < taps; ++j) {
    const int row = mirrored(corner.y + j - before, mosaic_size.y, period) * mosaic_size.x;
    [[unroll]] for (int i = 0; i < taps; ++i, ++tap) {
      const float w = texelFetch(weights, tap).x;
      const float value = texelFetch(mosaic, row + column[i]).x;
      sum += w * value;
      ratio += w * w;
      largest = w != 0.0 ? max(largest, value) : largest;
    }
  }
  warped.data[index] = largest < texelFetch(levels, kFrameSaturated).x ? vec2(sum, ratio) : vec2(0.0);
}
