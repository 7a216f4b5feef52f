// Reads one scale's features and irradiance with confidence, the coarser scale's result and, at the finest
// scale, the irradiance with confidence of the frame itself; writes this scale's result: a weighted mean of
// the 5x5 window, of the four nearest coarser pixels and, at the finest scale, of the frame's own 3x3 pixels.
// The weights are a softmax over the network's logits, less the squared distance of affinities, times the
// confidence of each pixel of a window (Vogels et al. 2018, with one convex sum instead of two that are added
// and subtracted). Additive AOVs take the beauty's weights, several at once, since weights are the main cost.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

layout(constant_id = 0) const int planes = 4;      // of four features each
layout(constant_id = 1) const int has_coarse = 1;  // 0: this is the coarsest scale
layout(constant_id = 2) const int has_own = 1;     // 1: this is the finest scale
layout(constant_id = 3) const int strip = 1;       // rows of pixels that one invocation computes
layout(constant_id = 4) const int framed = 0;      // as lib/head.glsl has it
layout(constant_id = 5) const int lights = 0;      // additive AOVs, 3 at most; 0: the beauty itself

layout(local_size_x = 128, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 affinities_size; };
layout(set = 0, binding = 0) uniform samplerBuffer features;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(set = 0, binding = 2) uniform samplerBuffer irradiance_confidence;
layout(set = 0, binding = 3) uniform samplerBuffer affinities;
layout(set = 0, binding = 4) uniform samplerBuffer own_irradiance_confidence;
layout(set = 0, binding = 5) uniform samplerBuffer light0;
layout(set = 0, binding = 6) uniform samplerBuffer light1;
layout(set = 0, binding = 7) uniform samplerBuffer light2;
layout(set = 0, binding = 8) uniform samplerBuffer own_light0;
layout(set = 0, binding = 9) uniform samplerBuffer own_light1;
layout(set = 0, binding = 10) uniform samplerBuffer own_light2;
layout(set = 0, binding = 11) uniform samplerBuffer coarse0;
layout(set = 0, binding = 12) uniform samplerBuffer coarse1;
layout(set = 0, binding = 13) uniform samplerBuffer coarse2;
layout(std430, set = 0, binding = 14) writeonly buffer Result0Buffer { vec4 data[]; } result0;
layout(std430, set = 0, binding = 15) writeonly buffer Result1Buffer { vec4 data[]; } result1;
layout(std430, set = 0, binding = 16) writeonly buffer Result2Buffer { vec4 data[]; } result2;

#include "lib/window.glsl"

const int kCoarseTaps = 4;
const int kOwnTaps = 9;
const int kFirstOwn = kTaps + kCoarseTaps;
const int kMostOutputs = kFirstOwn + kOwnTaps;
#include "lib/head.glsl"

/// Whether the window's tap is one of the frame's own 3x3 pixels, and the index of its weight there.
bool is_own(int row, int column, int pixel) { return has_own != 0 && abs(row - pixel - 2) <= 1 && abs(column - 2) <= 1; }
int own_tap(int row, int column, int pixel) { return kFirstOwn + 3 * (row - pixel - 1) + column - 1; }

int index_of(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), affinities_size - 1);
  return inside.y * affinities_size.x + inside.x;
}

void subtract_distances(ivec2 first) {
  vec4 middle[strip];
  [[unroll]] for (int s = 0; s < strip; ++s) middle[s] = texelFetch(affinities, index_of(first + ivec2(0, s)));
  [[unroll]] for (int j = 0; j < kWindowRows; ++j) {
    [[unroll]] for (int i = 0; i < kWindowColumns; ++i) {
      const vec4 tap = texelFetch(affinities, index_of(first + ivec2(i, j) - 2));
      [[unroll]] for (int s = 0; s < strip; ++s) {
        if (!is_in_window(j, s)) continue;
        const vec4 d = tap - middle[s];
        head[s * kMostOutputs + window_tap(j, i, s)] -= dot(d, d);
        if (is_own(j, i, s)) head[s * kMostOutputs + own_tap(j, i, s)] -= dot(d, d);
      }
    }
  }
}

/// The beauty, or additive AOVs.
const int kMostImages = 3;
const int kImages = lights > 0 ? lights : 1;

// Of weighted radiance, for each pixel of the strip and each image; of weights, for each pixel.
vec3 sum[strip * kImages];
float total[strip];
/// Of the tap at hand: the radiance of each image, and that of the frame itself.
vec3 value[kMostImages];
vec3 own_value[kMostImages];

void add(int pixel, float weight) {
  [[unroll]] for (int l = 0; l < kImages; ++l) sum[pixel * kImages + l] += weight * value[l];
  total[pixel] += weight;
}

void add_own(int pixel, float weight) {
  [[unroll]] for (int l = 0; l < kImages; ++l) sum[pixel * kImages + l] += weight * own_value[l];
  total[pixel] += weight;
}

void add_windows(ivec2 first) {
  [[unroll]] for (int j = 0; j < kWindowRows; ++j) {
    [[unroll]] for (int i = 0; i < kWindowColumns; ++i) {
      const int tap = index_of(first + ivec2(i, j) - 2);
      const vec4 beauty = texelFetch(irradiance_confidence, tap);
      value[0] = beauty.rgb;
      if (lights > 0) value[0] = texelFetch(light0, tap).rgb;
      if (lights > 1) value[1] = texelFetch(light1, tap).rgb;
      if (lights > 2) value[2] = texelFetch(light2, tap).rgb;
      const bool any_own = has_own != 0 && j > 0 && j < kWindowRows - 1 && i > 0 && i < kWindowColumns - 1;
      vec4 own = vec4(0.0);
      if (any_own) own = texelFetch(own_irradiance_confidence, tap);
      own_value[0] = own.rgb;
      if (any_own && lights > 0) own_value[0] = texelFetch(own_light0, tap).rgb;
      if (any_own && lights > 1) own_value[1] = texelFetch(own_light1, tap).rgb;
      if (any_own && lights > 2) own_value[2] = texelFetch(own_light2, tap).rgb;
      [[unroll]] for (int s = 0; s < strip; ++s) {
        if (!is_in_window(j, s)) continue;
        add(s, head[s * kMostOutputs + window_tap(j, i, s)] * beauty.a);
        if (is_own(j, i, s)) add_own(s, head[s * kMostOutputs + own_tap(j, i, s)] * own.a);
      }
    }
  }
}

/// The coarse pixel that covers the pixel, the two beside it on the pixel's side, and the one across the corner.
void add_coarse(ivec2 at, int pixel) {
  const ivec2 covering = at / 2;
  const ivec2 other = clamp(covering + 2 * (at % 2) - 1, ivec2(0), affinities_size / 2 - 1);
  [[unroll]] for (int t = 0; t < kCoarseTaps; ++t) {
    const ivec2 tap = ivec2(t % 2 == 0 ? covering.x : other.x, t / 2 == 0 ? covering.y : other.y);
    const int index = tap.y * (affinities_size.x / 2) + tap.x;
    value[0] = texelFetch(coarse0, index).rgb;
    if (lights > 1) value[1] = texelFetch(coarse1, index).rgb;
    if (lights > 2) value[2] = texelFetch(coarse2, index).rgb;
    add(pixel, head[pixel * kMostOutputs + kTaps + t]);
  }
}

void main() {
  const int taps = has_own != 0 ? kMostOutputs : has_coarse != 0 ? kFirstOwn : kTaps;
  load_head(taps);
  const ivec2 invocation = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 first = ivec2(min(invocation.x, affinities_size.x - 1), invocation.y * strip);
  apply_head(taps, first, affinities_size);
  subtract_distances(first);
  apply_softmax(taps);
  [[unroll]] for (int s = 0; s < strip; ++s) {
    [[unroll]] for (int l = 0; l < kImages; ++l) sum[s * kImages + l] = vec3(0.0);
    total[s] = 0.0;
  }
  add_windows(first);
  [[unroll]] for (int s = 0; s < strip; ++s) {
    const ivec2 at = ivec2(invocation.x, first.y + s);
    if (has_coarse != 0) add_coarse(min(at, affinities_size - 1), s);
    if (at.x < affinities_size.x && at.y < affinities_size.y) {
      const int index = at.y * affinities_size.x + at.x;
      const float divisor = max(total[s], 1e-30);
      result0.data[index] = vec4(sum[s * kImages] / divisor, 0.0);
      if (lights > 1) result1.data[index] = vec4(sum[s * kImages + 1] / divisor, 0.0);
      if (lights > 2) result2.data[index] = vec4(sum[s * kImages + 2] / divisor, 0.0);
    }
  }
}
