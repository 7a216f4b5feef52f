// Reads a history at the offsets, bilinearly and by the sharp filter. Not pure functions: the including
// kernel declares the constant `resample`, `history_color_size` and the texel buffers offset, history_color
// and target_origin; and SHARP_HISTORY if the sharp filter reads another image.
#include "lib/resample.glsl"

#ifndef SHARP_HISTORY
#define SHARP_HISTORY history_color
#endif

/// Taps of the sharp filter along an axis. Its middle taps are those of the bilinear filter.
const int kTaps = 4;

/// Where in the history a pixel comes from.
struct HistoryPlace {
  ivec2 nearest;  // the first of the bilinear taps
  vec2 t;         // in [0,1): the position between the taps
};

HistoryPlace place_in_history(ivec2 at, int index) {
  const vec2 displacement = texelFetch(offset, index).xy;
  const vec2 base = floor(displacement);
  return HistoryPlace(at + ivec2(texelFetch(target_origin, 0).xy) + ivec2(base), displacement - base);
}

/// Of tap (i, j) of the sharp filter.
int history_index(HistoryPlace place, int i, int j) {
  const ivec2 inside = clamp(place.nearest + ivec2(i, j) - 1, ivec2(0), history_color_size - 1);
  return inside.y * history_color_size.x + inside.x;
}

bool is_bilinear(int i, int j) {
  return (i == 1 || i == 2) && (j == 1 || j == 2);
}

/// The bilinear weight of tap (i, j), which is a bilinear one.
float tap_area(vec2 t, int i, int j) {
  return (i == 1 ? 1.0 - t.x : t.x) * (j == 1 ? 1.0 - t.y : t.y);
}

/// The bit of `holes` of a bilinear tap: there is no history under it.
int tap_bit(int i, int j) {
  return 1 << (2 * (j - 1) + i - 1);
}

/// The bit of `holes` that says so of any of the sharp filter's taps.
const int kAnyHole = 1 << 4;

struct HistoryRead {
  vec4 bilinear;
  vec4 sharp;
  bool is_sharp;  // history lies under all taps of the sharp filter, and `sharp` differs from `bilinear`
  bool found;
  vec4 lowest;  // of the taps of `bilinear`
  vec4 highest;
};

/// Whether a history is found under taps of this weight. Positions may lie up to half a pixel outside of the
/// image: their nearest pixel exists. A pixel with half of its weight or less in the history is mostly a hole.
bool is_found(HistoryPlace place, float weight) {
  const vec2 after_first = vec2(place.nearest) + place.t;
  const vec2 after_last = vec2(place.nearest + 1 - history_color_size) + place.t;
  const bool inside = all(greaterThanEqual(after_first, vec2(-0.5))) && all(lessThanEqual(after_last, vec2(0.5)));
  return inside && weight > 0.5;
}

HistoryRead read_history(HistoryPlace place, int holes) {
  float wx[kTaps];
  float wy[kTaps];
  if (resample == kResampleSpline) {
    cubic_b_spline(place.t.x, wx[0], wx[1], wx[2], wx[3]);
    cubic_b_spline(place.t.y, wy[0], wy[1], wy[2], wy[3]);
  } else {
    catmull_rom(place.t.x, wx[0], wx[1], wx[2], wx[3]);
    catmull_rom(place.t.y, wy[0], wy[1], wy[2], wy[3]);
  }
  vec4 sharp = vec4(0.0);
  vec4 color = vec4(0.0);
  float weight = 0.0;
  vec4 lowest = vec4(3.4e38);
  vec4 highest = vec4(-3.4e38);
  [[unroll]] for (int j = 0; j < kTaps; ++j) {
    [[unroll]] for (int i = 0; i < kTaps; ++i) {
      if (resample == kResampleBilinear && !is_bilinear(i, j)) continue;
      const int tap = history_index(place, i, j);
      const vec4 tap_color = texelFetch(history_color, tap);
      sharp += wx[i] * wy[j] * (resample == kResampleSpline ? texelFetch(SHARP_HISTORY, tap) : tap_color);
      if (!is_bilinear(i, j)) continue;
      const float w = (holes & tap_bit(i, j)) == 0 ? tap_area(place.t, i, j) : 0.0;
      color += w * tap_color;
      weight += w;
      lowest = w > 0.0 ? min(lowest, tap_color) : lowest;
      highest = w > 0.0 ? max(highest, tap_color) : highest;
    }
  }
  const vec4 bilinear = color / max(weight, 0.5);
  const bool has_sharp = resample != kResampleBilinear;
  return HistoryRead(bilinear, has_sharp ? sharp : bilinear,
                     has_sharp && (holes & kAnyHole) == 0 && place.t != vec2(0.0), is_found(place, weight),
                     lowest, highest);
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
