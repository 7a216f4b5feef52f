// Reads the reference's samples and a frame's at their places; writes their difference in deviations of its
// noise, and 1 where the sample is green, else -1; or (0, 0) where there is none. `place` is that of the first
// pixel in the pattern.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"
#include "lib/mosaic.glsl"

layout(constant_id = 0) const int period = 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer reference;
layout(set = 0, binding = 1) uniform samplerBuffer warped;
layout(set = 0, binding = 2) uniform samplerBuffer colors;
layout(set = 0, binding = 3) uniform samplerBuffer levels;
layout(set = 0, binding = 4) uniform samplerBuffer place;
layout(std430, set = 0, binding = 5) writeonly buffer DifferenceBuffer { vec2 data[]; } difference;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const float x = texelFetch(reference, index).x;
  const vec2 h = texelFetch(warped, index).xy;
  const float signal = 0.5 * (x + h.x);
  const float own = noise_variance(texelFetch(levels, kReferenceNoise).x, texelFetch(levels, kReferenceNoise + 1).x, signal);
  const float other = h.y * noise_variance(texelFetch(levels, kFrameNoise).x, texelFetch(levels, kFrameNoise + 1).x, signal);
  const bool usable = h.y > 0.0 && x < texelFetch(levels, kReferenceSaturated).x;
  const float d = clamp((x - h.x) / sqrt(own + other), -kMostDeviations, kMostDeviations);
  const ivec2 phase = (at + ivec2(texelFetch(place, 0).xy)) % period;
  const bool is_green = texelFetch(colors, phase.y * period + phase.x).x == 1.0;
  difference.data[index] = usable ? vec2(d, is_green ? 1.0 : -1.0) : vec2(0.0);
}
