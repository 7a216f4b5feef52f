// Reads the offsets and the history's colour and statistics, writes both where the target's pixels are: statistics
// bilinearly, colour by the chosen filter. A sharp filter's negative lobes would make negative radiance and ring around
// fireflies, so its result is mixed with the bilinear one, by one share for all channels, until it lies within the range of
// the four nearest taps: given that share the result is linear in the history, so images resampled alike still add up.
// `resample_taps` is what the filter's kernel is summed over, the history's colour or its spline coefficients. Statistics
// are (variance, effective sample count); a count of 0 means that there is no history. The history's images may show more
// of the frame than the target's: the target's first pixel then lies at target_origin.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/resample.glsl"
#include "shared/merge_params.h"

layout(constant_id = 0) const int resample = kResampleCatmullRom;

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { WarpHistoryParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer history_color;
layout(set = 0, binding = 2) uniform samplerBuffer resample_taps;
layout(set = 0, binding = 3) uniform samplerBuffer history_stats;
layout(set = 0, binding = 4) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 5) writeonly buffer WarpedColorBuffer { vec4 data[]; } warped_color;
layout(std430, set = 0, binding = 6) writeonly buffer WarpedStatsBuffer { vec2 data[]; } warped_stats;

int history_index(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), ivec2(p.history_width, p.history_height) - 1);
  return inside.y * p.history_width + inside.x;
}

/// The sharp filter's result; `holds` says whether there is history under all of its taps.
vec4 read_sharp(ivec2 corner, vec2 t, out bool holds) {
  float wx[4];
  float wy[4];
  if (resample == kResampleOMoms) {
    o_moms(t.x, wx[0], wx[1], wx[2], wx[3]);
    o_moms(t.y, wy[0], wy[1], wy[2], wy[3]);
  } else {
    catmull_rom(t.x, wx[0], wx[1], wx[2], wx[3]);
    catmull_rom(t.y, wy[0], wy[1], wy[2], wy[3]);
  }
  vec4 color = vec4(0.0);
  holds = true;
  [[unroll]] for (int j = 0; j < 4; ++j) {
    [[unroll]] for (int i = 0; i < 4; ++i) {
      const int tap = history_index(corner + ivec2(i, j));
      color += wx[i] * wy[j] * texelFetch(resample_taps, tap);
      holds = holds && texelFetch(history_stats, tap).y > 0.0;
    }
  }
  return color;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const vec2 displacement = texelFetch(offset, index).xy;
  const vec2 base = floor(displacement);
  const vec2 t = displacement - base;
  const ivec2 nearest = at + ivec2(texelFetch(target_origin, 0).xy) + ivec2(base);

  vec4 color = vec4(0.0);
  vec2 stats = vec2(0.0);
  float weight = 0.0;
  vec4 lowest = vec4(3.4e38);
  vec4 highest = vec4(-3.4e38);
  [[unroll]] for (int j = 0; j < 2; ++j) {
    [[unroll]] for (int i = 0; i < 2; ++i) {
      const int tap = history_index(nearest + ivec2(i, j));
      const vec2 tap_stats = texelFetch(history_stats, tap).xy;
      const vec4 tap_color = texelFetch(history_color, tap);
      const float area = (i == 0 ? 1.0 - t.x : t.x) * (j == 0 ? 1.0 - t.y : t.y);
      const float w = tap_stats.y > 0.0 ? area : 0.0;
      color += w * tap_color;
      stats += w * tap_stats;
      weight += w;
      lowest = w > 0.0 ? min(lowest, tap_color) : lowest;
      highest = w > 0.0 ? max(highest, tap_color) : highest;
    }
  }
  // Half a pixel of grace at the border: a tap there is still nearest to a pixel that exists. Without half of its weight
  // the pixel is mostly hole.
  const vec2 after_first = vec2(nearest) + t;
  const vec2 after_last = vec2(nearest + 1 - ivec2(p.history_width, p.history_height)) + t;
  const bool inside = all(greaterThanEqual(after_first, vec2(-0.5))) && all(lessThanEqual(after_last, vec2(0.5)));
  const bool found = inside && weight > 0.5;
  color /= max(weight, 0.5);
  if (resample != kResampleBilinear) {
    bool holds;
    const vec4 sharp = read_sharp(nearest - 1, t, holds);
    float share = holds && t != vec2(0.0) ? 1.0 : 0.0;
    [[unroll]] for (int c = 0; c < 4; ++c) share = min(share, sharp_share(sharp[c], color[c], lowest[c], highest[c]));
    color += share * (sharp - color);
  }
  // Beyond the range there is rounding alone, which would be seen as negative radiance or as change in an even surface.
  warped_color.data[index] = found ? clamp(color, lowest, highest) : vec4(0.0);
  warped_stats.data[index] = found ? stats / weight : vec2(0.0);
}
