// The 3x3 convolution of smooth/convolve and smooth/convolve_onto, kBlock pixels of a row per invocation. Not
// pure functions: the including kernel defines `p` (ConvolveParams), `result_size` and the texel buffers `source` and
// `weights`.

const int kTaps = kDirectTaps;

#include "lib/convolution_weights.glsl"

/// The sum for pixel x of the block and plane o of the result is element o * kBlock + x.
vec4 sums[kPlanesMade * kBlock];

/// Adds the source's part of the convolution to `sums`. Pixels outside of the image repeat its border.
void convolve(ivec2 at) {
  const int pixels = result_size.x * result_size.y;
  int columns[kBlock + 2];
  int rows[3];
  [[unroll]] for (int i = 0; i < kBlock + 2; ++i) columns[i] = clamp(at.x + i - 1, 0, result_size.x - 1);
  [[unroll]] for (int i = 0; i < 3; ++i) rows[i] = clamp(at.y + i - 1, 0, result_size.y - 1) * result_size.x;
  [[unroll]] for (int plane = 0; plane < planes; ++plane) {
    const int first = (p.first_plane + plane) * pixels;
    vec4 taps[3 * (kBlock + 2)];
    [[unroll]] for (int i = 0; i < 3 * (kBlock + 2); ++i) {
      taps[i] = texelFetch(source, first + rows[i / (kBlock + 2)] + columns[i % (kBlock + 2)]);
    }
    [[unroll]] for (int tap = 0; tap < kTaps; ++tap) {
      [[unroll]] for (int c = 0; c < 4; ++c) {
        [[unroll]] for (int o = 0; o < kPlanesMade; ++o) {
          const vec4 weight = weight_of(4 * plane + c, tap, o);
          [[unroll]] for (int x = 0; x < kBlock; ++x) {
            const float value = taps[tap / 3 * (kBlock + 2) + tap % 3 + x][c];
            sums[o * kBlock + x] = fma(vec4(value), weight, sums[o * kBlock + x]);
          }
        }
      }
    }
  }
}
