// Reads a frame, its variance in the merged frame, and the two results between which and the frame the output
// is mixed: the smoothed merged frame and the frame smoothed alone, each with (expected squared error, valid).
// Writes what `shares` averages over patches: (squared differences of frame and merged, of alone and merged,
// of frame and alone; 1) and (expected error of merged; variance; expected error of alone; 0), relative to the
// merged result's brightness; zeros for a pixel that is not finite.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer frame;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer merged;
layout(set = 0, binding = 3) uniform samplerBuffer merged_error;
layout(set = 0, binding = 4) uniform samplerBuffer alone;
layout(set = 0, binding = 5) uniform samplerBuffer alone_error;
layout(set = 0, binding = 6) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 7) writeonly buffer DifferenceBuffer { vec4 data[]; } differences;
layout(std430, set = 0, binding = 8) writeonly buffer ErrorBuffer { vec4 data[]; } errors;

float squared(vec3 difference, float scale) {
  const vec3 d = clamp(difference * scale, -kLargestDifference, kLargestDifference);
  return dot(d, d) / 3.0;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec3 x = texelFetch(frame, index).rgb;
  const vec3 y = texelFetch(merged, index).rgb;
  const vec3 z = texelFetch(alone, index).rgb;
  const vec2 noise = texelFetch(variance, index).xy;
  const float scale = 1.0 / brightness(y.r, y.g, y.b, texelFetch(exposure, 0).x);
  const vec3 of_estimates = vec3(texelFetch(merged_error, index).x, noise.x, texelFetch(alone_error, index).x);
  const vec3 deviations = min(sqrt(max(of_estimates, 0.0)) * scale, kLargestDifference);
  const bool valid = noise.y > 0.0;
  differences.data[index] = valid ? vec4(squared(x - y, scale), squared(z - y, scale), squared(x - z, scale), 1.0)
                                  : vec4(0.0);
  errors.data[index] = valid ? vec4(deviations * deviations, 0.0) : vec4(0.0);
}
