// Reads the new frame and the warped history; writes the history brought into a box of the new frame's colours around the
// pixel (history rectification, survey of Yang et al., section 4.2). The box is their range, or mean and gamma standard
// deviations (eq. 6); `clamp` limits each channel by itself, the others move the history towards the mean until it enters
// the box. What moved by a share k towards the mean of N samples has that much less of its own noise and count:
// v' = (1-k)^2 v + k^2 s^2 / N, 1/n' = (1-k)^2 / n + k^2.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/merge_params.h"

const int kClamp = 1;
const int kClip = 2;
const int kVariance = 3;

layout(constant_id = 0) const int kind = kClip;
layout(constant_id = 1) const int ycocg = 1;  // the box's axes: YCoCg instead of RGB
layout(constant_id = 2) const int radius = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { RectifyParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer warped_color;
layout(set = 0, binding = 3) uniform samplerBuffer warped_stats;
layout(std430, set = 0, binding = 4) writeonly buffer RectifiedColorBuffer { vec4 data[]; } rectified_color;
layout(std430, set = 0, binding = 5) writeonly buffer RectifiedStatsBuffer { vec2 data[]; } rectified_stats;

vec3 to_axes(vec3 c) {
  return ycocg != 0 ? vec3(0.25 * (c.r + c.b) + 0.5 * c.g, 0.5 * (c.r - c.b), 0.5 * c.g - 0.25 * (c.r + c.b)) : c;
}

vec3 from_axes(vec3 c) { return ycocg != 0 ? vec3(c.x + c.y - c.z, c.x + c.z, c.x - c.y - c.z) : c; }

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  vec3 lowest = vec3(3.4e38);
  vec3 highest = vec3(-3.4e38);
  vec3 sum = vec3(0.0);
  float noise = 0.0;
  float count = 0.0;
  [[unroll]] for (int j = -radius; j <= radius; ++j) {
    [[unroll]] for (int i = -radius; i <= radius; ++i) {
      const ivec2 tap_at = clamp(at + ivec2(i, j), ivec2(0), ivec2(p.width, p.height) - 1);
      const int tap = tap_at.y * p.width + tap_at.x;
      const vec2 stats = texelFetch(variance, tap).xy;
      const vec3 c = to_axes(texelFetch(color, tap).rgb);
      const bool counts = stats.y > 0.0;
      lowest = counts ? min(lowest, c) : lowest;
      highest = counts ? max(highest, c) : highest;
      sum += counts ? c : vec3(0.0);
      noise += counts ? stats.x : 0.0;
      count += counts ? 1.0 : 0.0;
    }
  }
  const vec3 mean = sum / max(count, 1.0);
  if (kind == kVariance) {
    // A second pass: the difference of moments would drown small deviations in the rounding of bright colours.
    vec3 squares = vec3(0.0);
    [[unroll]] for (int j = -radius; j <= radius; ++j) {
      [[unroll]] for (int i = -radius; i <= radius; ++i) {
        const ivec2 tap_at = clamp(at + ivec2(i, j), ivec2(0), ivec2(p.width, p.height) - 1);
        const int tap = tap_at.y * p.width + tap_at.x;
        const vec3 d = min(abs(to_axes(texelFetch(color, tap).rgb) - mean), vec3(1e18));
        squares += texelFetch(variance, tap).y > 0.0 ? d * d : vec3(0.0);
      }
    }
    const vec3 side = p.gamma * sqrt(squares / max(count, 1.0));
    lowest = mean - side;
    highest = mean + side;
  }

  const vec4 h = texelFetch(warped_color, index);
  const vec2 stats = texelFetch(warped_stats, index).xy;
  const vec3 axes = to_axes(h.rgb);
  const vec3 apart = axes - mean;
  const vec3 nearest = clamp(axes, lowest, highest);
  vec3 inside = nearest;
  float moved = 0.0;
  if (kind == kClamp) {
    const float way = length(apart);
    moved = way > 0.0 ? min(distance(nearest, axes) / way, 1.0) : 0.0;
  } else {
    // The share of the way to the mean that remains, from the axis that lies furthest beyond the box.
    float left = 1.0;
    [[unroll]] for (int c = 0; c < 3; ++c) {
      left = min(left, nearest[c] == axes[c] ? 1.0 : clamp((nearest[c] - mean[c]) / apart[c], 0.0, 1.0));
    }
    inside = mean + left * apart;
    moved = 1.0 - left;
  }
  const bool rectifies = count > 0.0 && stats.y > 0.0 && moved > 0.0;
  const float kept = (1.0 - moved) * (1.0 - moved);
  rectified_color.data[index] = rectifies ? vec4(from_axes(inside), h.a) : h;
  rectified_stats.data[index] =
      rectifies ? vec2(kept * stats.x + moved * moved * noise / (count * count), 1.0 / (kept / stats.y + moved * moved))
                : stats;
}
