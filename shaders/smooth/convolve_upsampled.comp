// A further part of a 3x3 convolution, over a source of half the size: pixel (x, y) of the result reads (x /
// 2, y / 2) of the source. It adds to what earlier parts left in the result. The nine neighbours of a fine
// pixel lie in 2x2 coarse pixels (which ones depends on whether its x and y are even). So there are 16
// weights instead of 9, each the sum of those that fall on one coarse pixel, and 4 products instead of 9. An
// invocation makes the 2x2 pixels of a coarse one in 2 planes: dispatch {ceil(width / 2), ceil(height / 2),
// planes of the result / 2}.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/convolve_params.h"

layout(push_constant) uniform Params { ivec2 result_size; ConvolveParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer source;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(std430, set = 0, binding = 2) buffer ResultBuffer { vec4 data[]; } result;

// Tap 4 * (2 * (y % 2) + x % 2) + 2 * row + column of the four coarse pixels.
const int kTaps = kUpsampledTaps;

#include "lib/convolution_weights.glsl"

void main() {
  load_weights();
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 size = (result_size + 1) / 2;
  int columns[3];
  int rows[3];
  [[unroll]] for (int i = 0; i < 3; ++i) columns[i] = clamp(at.x + i - 1, 0, size.x - 1);
  [[unroll]] for (int i = 0; i < 3; ++i) rows[i] = clamp(at.y + i - 1, 0, size.y - 1) * size.x;

  vec4 sums[kPlanesMade * 4];
  [[unroll]] for (int i = 0; i < kPlanesMade * 4; ++i) sums[i] = shared_weights[i / 4];
  [[unroll]] for (int plane = 0; plane < planes; ++plane) {
    const int first = (p.first_plane + plane) * size.x * size.y;
    vec4 around[9];
    [[unroll]] for (int i = 0; i < 9; ++i) around[i] = texelFetch(source, first + rows[i / 3] + columns[i % 3]);
    [[unroll]] for (int c = 0; c < 4; ++c) {
      [[unroll]] for (int tap = 0; tap < kTaps; ++tap) {
        const int pixel = tap / 4;
        const float value = around[3 * (pixel / 2 + tap / 2 % 2) + pixel % 2 + tap % 2][c];
        [[unroll]] for (int o = 0; o < kPlanesMade; ++o) {
          sums[4 * o + pixel] = fma(vec4(value), weight_of(4 * plane + c, tap, o), sums[4 * o + pixel]);
        }
      }
    }
  }

  [[unroll]] for (int i = 0; i < kPlanesMade * 4; ++i) {
    const ivec2 q = 2 * at + ivec2(i % 2, i / 2 % 2);
    const int index = ((first_output() + i / 4) * result_size.y + q.y) * result_size.x + q.x;
    if (q.x < result_size.x && q.y < result_size.y) result.data[index] = finished(result.data[index] + sums[i]);
  }
}
