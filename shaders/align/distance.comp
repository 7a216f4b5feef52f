// Reads target and source features of one level and the coarser level's offsets; writes, for one band of rows, the 25
// images of pixel distances d(target(p), source(p + coarse(p) + s)), s in [-2,2]^2 (Hanika et al. 2021, section 3.1).
// The source is read bilinearly: the 25 shifts share their fraction, so that one 6x6 footprint serves them all.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/distance.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int kind = kDistanceLogL1Centered;
layout(constant_id = 1) const int channels = 1;

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { DistanceParams p; };
layout(std430, set = 0, binding = 0) readonly buffer TargetBuffer { float data[]; } target;
layout(std430, set = 0, binding = 1) readonly buffer SourceBuffer { float data[]; } source;
layout(std430, set = 0, binding = 2) readonly buffer OffsetBuffer { vec2 data[]; } offset_coarse;
layout(std430, set = 0, binding = 3) writeonly buffer DistanceBuffer { float data[]; } distances;

#include "lib/offset_field.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.rows) return;
  const int row = p.first_row + at.y;
  const int plane_size = p.width * p.rows;
  const int out_index = at.y * p.width + at.x;
  if (row < 0 || row >= p.height) {
    for (int k = 0; k < 25; ++k) distances.data[k * plane_size + out_index] = 0.0;
    return;
  }
  const vec2 coarse = read_offset(ivec2(at.x, row), ivec2(p.coarse_width, p.coarse_height), p.coarse_scale);
  const vec2 base = floor(coarse);
  const vec2 t = coarse - base;
  const ivec2 corner = ivec2(at.x, row) + ivec2(base) - 2;

  float difference[25];
  for (int k = 0; k < 25; ++k) difference[k] = 0.0;
  for (int c = 0; c < channels; ++c) {
    const int plane = c * p.height;
    const float value = target.data[(plane + row) * p.width + at.x];
    float above[5];
    for (int j = 0; j < 6; ++j) {
      const int line = (plane + clamp(corner.y + j, 0, p.height - 1)) * p.width;
      float here[5];
      float left = source.data[line + clamp(corner.x, 0, p.width - 1)];
      for (int i = 0; i < 5; ++i) {
        const float right = source.data[line + clamp(corner.x + i + 1, 0, p.width - 1)];
        here[i] = mix(left, right, t.x);
        left = right;
      }
      if (j > 0) {
        for (int i = 0; i < 5; ++i) {
          difference[(j - 1) * 5 + i] += channel_difference(kind, value - mix(above[i], here[i], t.y));
        }
      }
      above = here;
    }
  }
  for (int k = 0; k < 25; ++k) {
    distances.data[k * plane_size + out_index] = pixel_distance(kind, difference[k]);
  }
}
