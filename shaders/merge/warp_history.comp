// Reads the offsets and the history's colour and statistics; writes both at the target's pixels: statistics
// bilinearly, colour by a sharp filter. The negative lobes of that filter would make negative radiance and
// rings around fireflies, so its result is mixed with the bilinear one, by one share for all channels, until
// it lies within the range of the four nearest taps. Given the share, the result is linear in the history, so
// images that are resampled with the same share still add up.
// Statistics are (variance, effective sample count); a count of 0 means that there is no history. If the
// history's images cover more of the frame than the target's, the target's first pixel lies at target_origin
// in them.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

layout(constant_id = 0) const int resample = 1;      // as in lib/resample.glsl
layout(constant_id = 1) const int carries = 0;       // 1: writes `share` and `holes`, for carried images

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 history_color_size; int first_row; };
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer history_color;
layout(set = 0, binding = 2) uniform samplerBuffer history_stats;
layout(set = 0, binding = 3) uniform samplerBuffer target_origin;
layout(set = 0, binding = 4) uniform samplerBuffer history_sharp;  // the history, or its spline coefficients
layout(std430, set = 0, binding = 5) writeonly buffer WarpedColorBuffer { vec4 data[]; } warped_color;
layout(std430, set = 0, binding = 6) writeonly buffer WarpedStatsBuffer { vec2 data[]; } warped_stats;
layout(std430, set = 0, binding = 7) writeonly buffer ShareBuffer { float data[]; } share;
layout(std430, set = 0, binding = 8) writeonly buffer HolesBuffer { float data[]; } holes;

#define SHARP_HISTORY history_sharp

#include "lib/read_history.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const int written = index - first_row * size.x;
  const HistoryPlace place = place_in_history(at, index);
  vec2 stats = vec2(0.0);
  float weight = 0.0;
  int of_holes = 0;
  [[unroll]] for (int j = 0; j < kTaps; ++j) {
    [[unroll]] for (int i = 0; i < kTaps; ++i) {
      if (resample == kResampleBilinear && !is_bilinear(i, j)) continue;
      const vec2 tap_stats = texelFetch(history_stats, history_index(place, i, j)).xy;
      const bool holds = tap_stats.y > 0.0;
      if (!holds) of_holes |= kAnyHole;
      if (!is_bilinear(i, j)) continue;
      if (!holds) of_holes |= tap_bit(i, j);
      const float w = holds ? tap_area(place.t, i, j) : 0.0;
      stats += w * tap_stats;
      weight += w;
    }
  }
  const HistoryRead h = read_history(place, of_holes);
  const float sharp = share_in_range(h);
  const vec4 color = h.bilinear + sharp * (h.sharp - h.bilinear);
  // Only rounding is left beyond the range. It would show as negative radiance or as change in an even
  // surface.
  const vec4 in_range = clamp(color, h.lowest, h.highest);
  warped_color.data[written] = h.found ? in_range : vec4(0.0);
  warped_stats.data[written] = h.found ? stats / weight : vec2(0.0);
  if (carries == 0) return;
  share.data[written] = sharp;
  holes.data[written] = float(of_holes);
}
