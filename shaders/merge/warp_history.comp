// Reads the offsets and the history's colour and statistics, writes both where the target's pixels are: colour by
// Catmull-Rom over the taps that hold something (survey of Yang et al., section 6.1), clamped to the range of the four
// nearest so that negative lobes neither make negative radiance nor ring around fireflies; statistics bilinearly.
// Statistics are (variance, effective sample count); a count of 0 means that there is no history.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/resample.glsl"
#include "shared/merge_params.h"

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { ImageParams p; };
layout(std430, set = 0, binding = 0) readonly buffer OffsetBuffer { vec2 data[]; } offset;
layout(std430, set = 0, binding = 1) readonly buffer ColorBuffer { vec4 data[]; } history_color;
layout(std430, set = 0, binding = 2) readonly buffer StatsBuffer { vec2 data[]; } history_stats;
layout(std430, set = 0, binding = 3) writeonly buffer WarpedColorBuffer { vec4 data[]; } warped_color;
layout(std430, set = 0, binding = 4) writeonly buffer WarpedStatsBuffer { vec2 data[]; } warped_stats;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const vec2 position = vec2(at) + offset.data[index];
  const ivec2 size = ivec2(p.width, p.height);
  // Half a pixel of grace at the border: a tap there is still nearest to a pixel that exists.
  if (any(lessThan(position, vec2(-0.5))) || any(greaterThan(position, vec2(size) - 0.5))) {
    warped_color.data[index] = vec4(0.0);
    warped_stats.data[index] = vec2(0.0);
    return;
  }
  const vec2 base = floor(position);
  const vec2 t = position - base;
  float wx[4];
  float wy[4];
  catmull_rom(t.x, wx[0], wx[1], wx[2], wx[3]);
  catmull_rom(t.y, wy[0], wy[1], wy[2], wy[3]);

  vec4 color = vec4(0.0);
  float weight = 0.0;
  vec2 stats = vec2(0.0);
  float stats_weight = 0.0;
  vec4 lowest = vec4(3.4e38);
  vec4 highest = vec4(-3.4e38);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const float w = wx[i] * wy[j];
      const ivec2 tap = clamp(ivec2(base) + ivec2(i, j) - 1, ivec2(0), size - 1);
      const vec2 tap_stats = history_stats.data[tap.y * p.width + tap.x];
      if (tap_stats.y <= 0.0) continue;
      const vec4 tap_color = history_color.data[tap.y * p.width + tap.x];
      color += w * tap_color;
      weight += w;
      const bool inner = (i == 1 || i == 2) && (j == 1 || j == 2);
      const float bilinear = inner ? (i == 1 ? 1.0 - t.x : t.x) * (j == 1 ? 1.0 - t.y : t.y) : 0.0;
      if (bilinear > 0.0) {
        stats += bilinear * tap_stats;
        stats_weight += bilinear;
        lowest = min(lowest, tap_color);
        highest = max(highest, tap_color);
      }
    }
  }
  // Without half of the bilinear weight the pixel is mostly hole; a small Catmull-Rom weight would amplify the rest.
  const bool holds = stats_weight > 0.5 && weight > 0.5;
  warped_color.data[index] = holds ? clamp(color / weight, lowest, highest) : vec4(0.0);
  warped_stats.data[index] = holds ? stats / stats_weight : vec2(0.0);
}
