// One step of an a-trous filter on the exposed luminance (Dammertz et al. 2010, "Edge-avoiding a-trous
// wavelet transform for fast global illumination filtering"): reads luminance and guide features; writes the
// mean of B3-spline taps `step` pixels apart, weighted by the similarity of their guides. The last step
// compresses the range, which makes the result a matching feature. Averaged luminance leaves the search less
// noise to match, so patches may be smaller.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int guide_planes = 0;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; PrefilterParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer radiance;
layout(set = 0, binding = 1) uniform samplerBuffer guides;
layout(std430, set = 0, binding = 2) writeonly buffer FilteredBuffer { float data[]; } filtered;

/// Squared distance of guides, in the features' range, at which a weight falls by a factor of e.
const float kGuideSpread = 2.0;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const float spline[3] = float[3](0.375, 0.25, 0.0625);
  const int plane_size = size.x * size.y;
  const int here = at.y * size.x + at.x;
  float sum = 0.0;
  float weights = 0.0;
  [[unroll]] for (int j = -2; j <= 2; ++j) {
    const int line = clamp(at.y + j * p.step, 0, size.y - 1) * size.x;
    [[unroll]] for (int i = -2; i <= 2; ++i) {
      const int tap = line + clamp(at.x + i * p.step, 0, size.x - 1);
      float distance = 0.0;
      [[unroll]] for (int plane = 0; plane < guide_planes; ++plane) {
        const float d = texelFetch(guides, plane * plane_size + tap).x - texelFetch(guides, plane * plane_size + here).x;
        distance += d * d;
      }
      const float weight = spline[abs(i)] * spline[abs(j)] * exp(-distance / kGuideSpread);
      sum += weight * texelFetch(radiance, tap).x;
      weights += weight;
    }
  }
  filtered.data[p.plane * plane_size + here] = radiance_feature(sum / weights, p.weight);
}
