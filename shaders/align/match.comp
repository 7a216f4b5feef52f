// One level of the search in one pass (Hanika et al. 2021, section 3.1): reads the target's features, the
// source's features as warp_source wrote them and the coarser level's offsets; writes each pixel's offset at
// this level and its residual.
// The 25 distances of a pixel stay within the invocation, which makes a strip of `strip_columns` x
// `strip_rows` pixels from top to bottom. For each of the 25 shifts and each column that a patch of the strip
// covers, it keeps the sum over the patch's rows; each step adds a row and removes the oldest. Strips end
// after `strip_rows` rows, which bounds the rounding error.
// Under a logarithmic distance, sums are logarithms of products (lib/distance.glsl). `log_of` says which
// product stays within the range of floats: that of a patch, of a column or of one pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/distance.glsl"
#include "lib/log2.glsl"
#include "shared/align_params.h"

const int kLogOfPatch = 0;
const int kLogOfColumn = 1;
const int kLogOfPixel = 2;

layout(constant_id = 0) const int kind = kDistanceLogL1Centered;
layout(constant_id = 1) const int channels = 1;
layout(constant_id = 2) const int radius = 2;
layout(constant_id = 3) const int strip_columns = 8;
layout(constant_id = 4) const int strip_rows = 32;
layout(constant_id = 5) const int log_of = kLogOfPatch;

const int kPatch = 2 * radius + 1;
const int kColumns = strip_columns + 2 * radius;
const bool kMultiplies = kind >= kDistanceLogL1 && log_of != kLogOfPixel;

layout(local_size_x = 8) in;
layout(push_constant) uniform Params { ivec2 target_size; ivec2 offset_coarse_size; MatchParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer target;
layout(set = 0, binding = 1) uniform samplerBuffer warped;
layout(set = 0, binding = 2) uniform samplerBuffer offset_coarse;
layout(std430, set = 0, binding = 3) writeonly buffer OffsetBuffer { vec2 data[]; } offset;
layout(std430, set = 0, binding = 4) writeonly buffer ResidualBuffer { float data[]; } residual;

#include "lib/choice.glsl"

/// First element of a row; rows outside of the image repeat its border.
int line(int row, int plane) { return (plane * target_size.y + clamp(row, 0, target_size.y - 1)) * target_size.x; }

// A global, since an array of specialized size cannot be a parameter.
float difference[5 * kColumns];

/// Sets `difference` for the five shifts of row `sy` and every column.
void find_differences(int row, int sy, int first_column) {
  [[unroll]] for (int i = 0; i < 5 * kColumns; ++i) difference[i] = 0.0;
  [[unroll]] for (int plane = 0; plane < channels; ++plane) {
    const int target_line = line(row, plane);
    const int source_line = line(row + sy, plane);
    float source[kColumns + 4];
    [[unroll]] for (int i = 0; i < kColumns + 4; ++i) {
      source[i] = texelFetch(warped, source_line + clamp(first_column + i - 2, 0, target_size.x - 1)).x;
    }
    [[unroll]] for (int i = 0; i < kColumns; ++i) {
      const float value = texelFetch(target, target_line + clamp(first_column + i, 0, target_size.x - 1)).x;
      [[unroll]] for (int k = 0; k < 5; ++k) difference[k * kColumns + i] += channel_difference(kind, value - source[i + k]);
    }
  }
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) * ivec2(strip_columns, strip_rows);
  if (at.x >= target_size.x || at.y >= target_size.y) return;
  const int first_column = at.x - radius;
  const int first_row = max(at.y - radius, 0);
  const int end_row = min(at.y + strip_rows, target_size.y);
  float inside[kColumns];  // columns outside of the image count in no patch
  [[unroll]] for (int i = 0; i < kColumns; ++i) {
    inside[i] = first_column + i >= 0 && first_column + i < target_size.x ? 1.0 : 0.0;
  }

  float column[25 * kColumns];
  [[unroll]] for (int i = 0; i < 25 * kColumns; ++i) column[i] = kMultiplies ? 1.0 : 0.0;
  [[dont_unroll]] for (int row = first_row; row < end_row + radius; ++row) {
    const int old_row = row - kPatch;
    const float adds = row < target_size.y ? 1.0 : 0.0;
    const float removes = old_row >= first_row ? 1.0 : 0.0;
    [[unroll]] for (int sy = 0; sy < 5; ++sy) {
      find_differences(row, sy - 2, first_column);
      float added[5 * kColumns];
      [[unroll]] for (int i = 0; i < 5 * kColumns; ++i) added[i] = difference[i];
      find_differences(old_row, sy - 2, first_column);
      [[unroll]] for (int i = 0; i < 5 * kColumns; ++i) {
        const float add = adds * inside[i % kColumns];
        const float remove = removes * inside[i % kColumns];
        const int c = 5 * kColumns * sy + i;
        if (kMultiplies) {
          column[c] *= (1.0 + 0.5 * add * added[i]) / (1.0 + 0.5 * remove * difference[i]);
        } else {
          column[c] += add * distance_excess(kind, added[i]) - remove * distance_excess(kind, difference[i]);
        }
      }
    }
    const int y = row - radius;
    // A loop instead of a branch: a driver may execute a branch that no invocation takes.
    for (bool is_complete = y >= at.y; is_complete; is_complete = false) {
      float cost[strip_columns][25];
      [[unroll]] for (int k = 0; k < 25; ++k) {
        float sums[kColumns];
        [[unroll]] for (int i = 0; i < kColumns; ++i) {
          const float c = column[k * kColumns + i];
          sums[i] = kMultiplies && log_of == kLogOfColumn ? log2_of_product(max(c, 1.0)) : c;
        }
        [[unroll]] for (int i = 0; i < strip_columns; ++i) {
          float sum = sums[i];
          [[unroll]] for (int j = 1; j < kPatch; ++j) sum = kMultiplies && log_of == kLogOfPatch ? sum * sums[i + j] : sum + sums[i + j];
          cost[i][k] = kMultiplies && log_of == kLogOfPatch ? log2_of_product(max(sum, 1.0)) : sum;
        }
      }
      [[unroll]] for (int i = 0; i < strip_columns; ++i) {
        if (at.x + i < target_size.x) {
          choose(kind, cost[i], ivec2(at.x + i, y), target_size, radius, p.refine != 0,
                 offset_coarse_size, p.coarse_scale);
        }
      }
    }
  }
}
