// Reads a colour image and the frame's exposure; writes the exposed luminance averaged over downsample x
// downsample pixels, as a matching feature. Averages come before range compression, since the mean of
// compressed noisy values is lower than the compressed mean: a target that is noisier than the history would
// look darker and match the history's darker pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "shared/align_params.h"

/// A pixel more than this many times brighter than its brightest neighbour is a firefly.
const float kFirefly = 4.0;

layout(constant_id = 0) const int downsample = 1;
/// Of the square of pixels that are read: those of the feature, and one around them.
const int side = downsample + 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 color_size; RadianceFeatureParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 2) writeonly buffer FeaturesBuffer { float data[]; } features;

bool is_inside(ivec2 at) { return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, color_size)); }

/// Exposed luminances of the pixels that are read; 0 outside the frame.
float light[side * side];

/// That of pixel k of them, or the mean of its nearest neighbours, four inside the frame, if it is a firefly.
float without_firefly(int k, ivec2 at) {
  const float here = light[k];
  float brightest = 0.0;
  float sum = 0.0;
  float count = 0.0;
  [[unroll]] for (int n = 0; n < 9; ++n) {
    if (n == 4) continue;
    const ivec2 step = ivec2(n % 3, n / 3) - 1;
    const float x = light[k + step.y * side + step.x];
    brightest = max(brightest, x);
    sum += n % 2 == 1 ? x : 0.0;
    count += n % 2 == 1 && is_inside(at + step) ? 1.0 : 0.0;
  }
  return count > 0.0 && here > kFirefly * brightest ? sum / count : here;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const ivec2 first = at * downsample - 1;
  const float e = texelFetch(exposure, 0).x;
  [[unroll]] for (int k = 0; k < side * side; ++k) {
    const ivec2 from = first + ivec2(k % side, k / side);
    const ivec2 tap = clamp(from, ivec2(0), color_size - 1);
    const vec4 c = texelFetch(color, tap.y * color_size.x + tap.x);
    light[k] = is_inside(from) ? exposed(luminance(c.r, c.g, c.b), e) : 0.0;
  }
  float sum = 0.0;
  int count = 0;
  [[unroll]] for (int y = 1; y <= downsample; ++y) {
    [[unroll]] for (int x = 1; x <= downsample; ++x) {
      const ivec2 pixel = first + ivec2(x, y);
      const bool counts = is_inside(pixel);
      const float value = without_firefly(y * side + x, pixel);
      sum += counts ? value : 0.0;
      count += counts ? 1 : 0;
    }
  }
  features.data[(p.plane * size.y + at.y) * size.x + at.x] = p.weight * compress(sum / float(count));
}
