// For patches too large for `match`: reads the features of the target and of the warped source; writes, for
// one band of rows, the 25 images of pixel distances d(target(p), warped(p + s)), s in [-2,2]^2, less the
// distance of equal pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/distance.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int kind = kDistanceLogL1Centered;
layout(constant_id = 1) const int channels = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { DistanceParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer target;
layout(set = 0, binding = 1) uniform samplerBuffer warped;
layout(std430, set = 0, binding = 2) writeonly buffer DistanceBuffer { float data[]; } distances;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.rows) return;
  const int row = p.first_row + at.y;
  const int plane_size = p.width * p.rows;
  const bool outside = row < 0 || row >= p.height;

  float difference[25];
  [[unroll]] for (int k = 0; k < 25; ++k) difference[k] = 0.0;
  [[dont_unroll]] for (int c = 0; c < channels; ++c) {
    const int plane = c * p.height;
    const float value = texelFetch(target, (plane + clamp(row, 0, p.height - 1)) * p.width + at.x).x;
    [[unroll]] for (int k = 0; k < 25; ++k) {
      const int line = (plane + clamp(row + k / 5 - 2, 0, p.height - 1)) * p.width;
      const float other = texelFetch(warped, line + clamp(at.x + k % 5 - 2, 0, p.width - 1)).x;
      difference[k] += channel_difference(kind, value - other);
    }
  }
  [[unroll]] for (int k = 0; k < 25; ++k) {
    distances.data[k * plane_size + at.y * p.width + at.x] = outside ? 0.0 : distance_excess(kind, difference[k]);
  }
}
