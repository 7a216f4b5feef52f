// History rectification (survey of Yang et al. 2020, section 4.2). Pure functions.

/// RGB in the space of the bounds: luma, orange-blue and green-magenta. The matrix and its inverse are exact.
vec3 to_ycocg(vec3 c) {
  return vec3(0.25 * c.r + 0.5 * c.g + 0.25 * c.b, 0.5 * c.r - 0.5 * c.b, -0.25 * c.r + 0.5 * c.g - 0.25 * c.b);
}

vec3 from_ycocg(vec3 c) {
  const float t = c.x - c.z;
  return vec3(t + c.y, c.x + c.z, t - c.y);
}

/// `history`, moved towards `middle`, which lies within the bounds, just far enough to lie within them. Excesses
/// within rounding are ignored: in a channel without contrast they would move it all the way.
vec3 clip_towards(vec3 history, vec3 middle, vec3 low, vec3 high) {
  const vec3 way = history - middle;
  const float rounding = 2e-6 * max(abs(history.x), max(abs(history.y), abs(history.z)));
  float share = 1.0;
  [[unroll]] for (int c = 0; c < 3; ++c) {
    if (history[c] > high[c] + rounding) share = min(share, max(high[c] - middle[c], 0.0) / way[c]);
    if (history[c] < low[c] - rounding) share = min(share, max(middle[c] - low[c], 0.0) / -way[c]);
  }
  return share < 1.0 ? middle + share * way : history;
}
