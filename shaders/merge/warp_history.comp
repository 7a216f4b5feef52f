// Reads the offsets and the history's colour and statistics, writes both where the target's pixels are: colour by
// Catmull-Rom over the taps that hold something (survey of Yang et al., section 6.1), clamped to the range of the four
// nearest so that negative lobes neither make negative radiance nor ring around fireflies; statistics bilinearly.
// Statistics are (variance, effective sample count); a count of 0 means that there is no history. The history's images may
// show more of the frame than the target's: the target's first pixel then lies at target_origin.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/resample.glsl"
#include "shared/merge_params.h"

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { WarpHistoryParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer history_color;
layout(set = 0, binding = 2) uniform samplerBuffer history_stats;
layout(set = 0, binding = 3) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 4) writeonly buffer WarpedColorBuffer { vec4 data[]; } warped_color;
layout(std430, set = 0, binding = 5) writeonly buffer WarpedStatsBuffer { vec2 data[]; } warped_stats;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const vec2 displacement = texelFetch(offset, index).xy;
  const vec2 base = floor(displacement);
  const vec2 t = displacement - base;
  const ivec2 corner = at + ivec2(texelFetch(target_origin, 0).xy) + ivec2(base) - 1;
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
  [[unroll]] for (int j = 0; j < 4; ++j) {
    const int row = clamp(corner.y + j, 0, p.history_height - 1) * p.history_width;
    [[unroll]] for (int i = 0; i < 4; ++i) {
      const int tap = row + clamp(corner.x + i, 0, p.history_width - 1);
      const vec2 tap_stats = texelFetch(history_stats, tap).xy;
      const vec4 tap_color = texelFetch(history_color, tap);
      const bool holds = tap_stats.y > 0.0;
      const float w = holds ? wx[i] * wy[j] : 0.0;
      color += w * tap_color;
      weight += w;
      if (i < 1 || i > 2 || j < 1 || j > 2) continue;
      const float bilinear = holds ? (i == 1 ? 1.0 - t.x : t.x) * (j == 1 ? 1.0 - t.y : t.y) : 0.0;
      stats += bilinear * tap_stats;
      stats_weight += bilinear;
      if (bilinear > 0.0) {
        lowest = min(lowest, tap_color);
        highest = max(highest, tap_color);
      }
    }
  }
  // Half a pixel of grace at the border: a tap there is still nearest to a pixel that exists. Without half of the
  // bilinear weight the pixel is mostly hole; a small Catmull-Rom weight would amplify the rest.
  const vec2 after_first = vec2(corner + 1) + t;
  const vec2 after_last = vec2(corner + 2 - ivec2(p.history_width, p.history_height)) + t;
  const bool inside = all(greaterThanEqual(after_first, vec2(-0.5))) && all(lessThanEqual(after_last, vec2(0.5)));
  const bool found = inside && stats_weight > 0.5 && weight > 0.5;
  warped_color.data[index] = found ? clamp(color / weight, lowest, highest) : vec4(0.0);
  warped_stats.data[index] = found ? stats / stats_weight : vec2(0.0);
}
