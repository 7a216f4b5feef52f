// Reads a history at the offsets, bilinearly and by the sharp filter. Not pure functions: the including
// kernel declares the constant `resample`, `history_color_size` and the texel buffers offset, history_color,
// history_stats and target_origin; and SHARP_HISTORY if the sharp filter reads another image.
#include "lib/resample.glsl"

#ifndef SHARP_HISTORY
#define SHARP_HISTORY history_color
#endif

struct HistoryRead {
  vec4 bilinear;
  vec4 sharp;
  bool is_sharp;  // history lies under all taps of the sharp filter, and `sharp` differs from `bilinear`
  vec2 stats;
  bool found;
  vec4 lowest;  // of the taps of `bilinear`
  vec4 highest;
};

int history_index(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), history_color_size - 1);
  return inside.y * history_color_size.x + inside.x;
}

/// The sharp filter's result; `holds` says whether there is history under all of its taps.
vec4 read_sharp(ivec2 corner, vec2 t, out bool holds) {
  float wx[4];
  float wy[4];
  if (resample == kResampleSpline) {
    cubic_b_spline(t.x, wx[0], wx[1], wx[2], wx[3]);
    cubic_b_spline(t.y, wy[0], wy[1], wy[2], wy[3]);
  } else {
    catmull_rom(t.x, wx[0], wx[1], wx[2], wx[3]);
    catmull_rom(t.y, wy[0], wy[1], wy[2], wy[3]);
  }
  vec4 color = vec4(0.0);
  holds = true;
  [[unroll]] for (int j = 0; j < 4; ++j) {
    [[unroll]] for (int i = 0; i < 4; ++i) {
      const int tap = history_index(corner + ivec2(i, j));
      color += wx[i] * wy[j] * texelFetch(SHARP_HISTORY, tap);
      holds = holds && texelFetch(history_stats, tap).y > 0.0;
    }
  }
  return color;
}

HistoryRead read_history(ivec2 at, int index) {
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
  // Positions may lie up to half a pixel outside of the image: their nearest pixel exists. A pixel with half
  // of its weight or less in the history is mostly a hole.
  const vec2 after_first = vec2(nearest) + t;
  const vec2 after_last = vec2(nearest + 1 - history_color_size) + t;
  const bool inside = all(greaterThanEqual(after_first, vec2(-0.5))) && all(lessThanEqual(after_last, vec2(0.5)));
  const bool found = inside && weight > 0.5;
  const vec4 bilinear = color / max(weight, 0.5);
  vec4 sharp = bilinear;
  bool is_sharp = false;
  if (resample != kResampleBilinear) {
    sharp = read_sharp(nearest - 1, t, is_sharp);
    is_sharp = is_sharp && t != vec2(0.0);
  }
  return HistoryRead(bilinear, sharp, is_sharp, found ? stats / weight : vec2(0.0), found, lowest, highest);
}

/// The largest share of the sharp filter, one for all channels, that keeps the result within the range of the
/// nearest taps.
float share_in_range(HistoryRead h) {
  float sharp = h.is_sharp ? 1.0 : 0.0;
  [[unroll]] for (int c = 0; c < 4; ++c) {
    sharp = min(sharp, sharp_share(h.sharp[c], h.bilinear[c], h.lowest[c], h.highest[c]));
  }
  return sharp;
}
