/// Limits differences of colours, so that sums of their squares stay within the range of floats.
const float kLargest = 1e16;

vec3 limited(vec3 difference) { return clamp(difference, -kLargest, kLargest); }

/// Mean square over the channels.
float squared(vec3 difference) {
  difference = limited(difference);
  return dot(difference, difference) / 3.0;
}
