// Reads a mosaic and its noise; writes one value for each block of `block` x `block` samples: the mean of its
// colours' means, weighted by each colour's share of the mosaic so that blocks with other counts of a colour
// agree, in standard deviations of its noise. This is what the aligner matches (Hanika et al. 2021, section 4).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/mosaic.glsl"
#include "shared/burst_params.h"

layout(constant_id = 0) const int block = 2;
layout(constant_id = 1) const int period = 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 mosaic_size; ReduceParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer mosaic;
layout(set = 0, binding = 1) uniform samplerBuffer colors;
layout(set = 0, binding = 2) uniform samplerBuffer levels;
layout(std430, set = 0, binding = 3) writeonly buffer FeatureBuffer { float data[]; } feature;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  vec3 sum = vec3(0.0);
  vec3 count = vec3(0.0);
  for (int y = 0; y < block; ++y) {
    for (int x = 0; x < block; ++x) {
      // Blocks at the border may be cut; what is outside is read a period before.
      const int qx = mirrored(at.x * block + x, mosaic_size.x, period);
      const int qy = mirrored(at.y * block + y, mosaic_size.y, period);
      const float color = texelFetch(colors, (qy % period) * period + qx % period).x;
      const vec3 is = vec3(color == 0.0, color == 1.0, color == 2.0);
      sum += is * texelFetch(mosaic, qy * mosaic_size.x + qx).x;
      count += is;
    }
  }
  const vec3 share = vec3(p.red_share, p.green_share, p.blue_share) * vec3(greaterThan(count, vec3(0.0)));
  const float mean = dot(share / max(count, vec3(1.0)), sum) / (share.r + share.g + share.b);
  const float a = texelFetch(levels, kReferenceNoise).x;
  const float b = texelFetch(levels, kReferenceNoise + 1).x;
  feature.data[at.y * size.x + at.x] = float(block) * stabilized(a, b, mean);
}
