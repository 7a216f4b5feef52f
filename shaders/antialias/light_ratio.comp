// Reads the light of the frame and of the history in tiles (tile_light). Writes for each tile by what to multiply the
// history's colours, and 1.
// A pixel cannot tell a change of the light from an edge that its samples meet this time, but many tiles can: the ratio
// of the sums over the tiles around is that of the lights if they differ by more than the tiles' deviations from that
// ratio explain (the ratio estimator of survey sampling: Cochran, "Sampling Techniques", 1977, chapter 6).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer of_frame;
layout(set = 0, binding = 1) uniform samplerBuffer of_history;
layout(std430, set = 0, binding = 2) writeonly buffer LightBuffer { vec4 data[]; } light;

/// Tiles on a side of the square that ratios are measured over.
const int kAround = 9;
/// Effective tiles below which their deviations say little.
const float kFewestTiles = 8.0;
/// Squared standard errors of the ratio up to which it is noise, and from which on it holds. Neighbouring tiles share
/// edges, so that the errors are larger than those of independent ones.
const float kNoise = 9.0;
const float kCertain = 36.0;
/// Smallest variance of tiles over their mean square: floats resolve no less.
const float kRounding = 1e-6;
/// Shares of the change that a tile and its neighbours show: up to kAbsent it is none of theirs, from kPresent on they
/// take it whole. Noise moves shares, and changes nothing near 0 and 1.
const float kAbsent = 0.25;
const float kPresent = 0.75;
/// Lights that differ by more than this, 2^30, tell nothing of each other.
const float kLargestRatio = 1073741824.0;

struct Sums {
  vec4 frame;
  vec4 history;
  vec3 frame_squares;
  vec3 products;
  vec3 history_squares;
  float squared_weights;
  vec4 near_frame;  // of the tile and its neighbours
  vec4 near_history;
};

Sums sums_around(ivec2 at) {
  Sums sums = Sums(vec4(0.0), vec4(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0, vec4(0.0), vec4(0.0));
  const ivec2 first = clamp(at - kAround / 2, ivec2(0), max(size - kAround, 0));
  const ivec2 end = min(first + kAround, size);
  for (int y = first.y; y < end.y; ++y) {
    for (int x = first.x; x < end.x; ++x) {
      const vec4 f = texelFetch(of_frame, y * size.x + x);
      const vec4 h = texelFetch(of_history, y * size.x + x);
      sums.frame += f;
      sums.history += h;
      sums.frame_squares += f.rgb * f.rgb;
      sums.products += f.rgb * h.rgb;
      sums.history_squares += h.rgb * h.rgb;
      sums.squared_weights += f.a * f.a;
      if (abs(x - at.x) > 1 || abs(y - at.y) > 1) continue;
      sums.near_frame += f;
      sums.near_history += h;
    }
  }
  return sums;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const Sums sums = sums_around(at);
  const float n = sums.squared_weights > 0.0 ? sums.frame.a * sums.frame.a / sums.squared_weights : 0.0;
  vec3 ratio = vec3(1.0);
  for (int c = 0; c < 3 && n >= kFewestTiles; ++c) {
    const float f = sums.frame[c];
    const float h = sums.history[c];
    const float most = max(f, h);
    if (min(f, h) <= 0.0 || most > kLargestRatio * min(f, h)) continue;
    const float r = f / h;
    // Deviations of the brighter from its share of the darker: the reverse would hide a firefly of the history.
    const float q = most / min(f, h);
    const vec2 scale = f > h ? vec2(1.0, q) : vec2(q, 1.0);  // of the frame and of the history
    const float squares = scale.x * scale.x * sums.frame_squares[c] - 2.0 * q * sums.products[c] +
                          scale.y * scale.y * sums.history_squares[c];
    const float least = kRounding * max(sums.frame_squares[c], sums.history_squares[c]);
    const float deviation = max(squares, least) / (n - 1.0);
    const float holds = deviation > 0.0 ? smoothstep(kNoise, kCertain, (f - h) * (f - h) / n / deviation) : 0.0;
    // Where the light around changed but not here, as beside the edge of a shadow, the history stays as it is.
    const float expected = (r - 1.0) * sums.near_history[c];
    const float found = sums.near_frame[c] - sums.near_history[c];
    const float here = expected != 0.0 ? smoothstep(kAbsent, kPresent, found / expected) : 0.0;
    ratio[c] = mix(1.0, r, here * holds);
  }
  light.data[at.y * size.x + at.x] = vec4(ratio, 1.0);
}
