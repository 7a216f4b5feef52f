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

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 color_size; RadianceFeatureParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 2) writeonly buffer FeaturesBuffer { float data[]; } features;

float exposed_at(ivec2 at, float e) {
  const vec4 c = texelFetch(color, at.y * color_size.x + at.x);
  return exposed(luminance(c.r, c.g, c.b), e);
}

/// The pixel's exposed luminance, or the mean of its nearest neighbours, four inside the frame, if it is a
/// firefly.
float without_firefly(ivec2 at, float e) {
  const float here = exposed_at(at, e);
  float brightest = 0.0;
  float sum = 0.0;
  float count = 0.0;
  [[unroll]] for (int k = 0; k < 9; ++k) {
    if (k == 4) continue;
    const ivec2 next = at + ivec2(k % 3, k / 3) - 1;
    const bool inside = all(greaterThanEqual(next, ivec2(0))) && all(lessThan(next, color_size));
    const float x = inside ? exposed_at(next, e) : 0.0;
    brightest = max(brightest, x);
    sum += k % 2 == 1 ? x : 0.0;
    count += k % 2 == 1 && inside ? 1.0 : 0.0;
  }
  return count > 0.0 && here > kFirefly * brightest ? sum / count : here;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const ivec2 last = min((at + 1) * p.downsample, color_size);
  const float e = texelFetch(exposure, 0).x;
  float sum = 0.0;
  int count = 0;
  for (int y = at.y * p.downsample; y < last.y; ++y) {
    for (int x = at.x * p.downsample; x < last.x; ++x) {
      sum += without_firefly(ivec2(x, y), e);
      ++count;
    }
  }
  features.data[(p.plane * size.y + at.y) * size.x + at.x] = p.weight * compress(sum / float(count));
}
