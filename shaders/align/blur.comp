// Reads 25 distance images of a band of rows; writes their box sums along one direction, so that two passes
// sum a square patch. An invocation slides its sum along a run of kRun pixels and starts afresh at the next
// run, which bounds the rounding error. Rows outside of the image already hold zero; columns outside count as
// zero here.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/align_params.h"

const int kRun = 16;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { BlurParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer distances;
layout(std430, set = 0, binding = 1) writeonly buffer SumBuffer { float data[]; } sums;

// One invocation per run and image; the dispatch counts runs along the blurred direction.
void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  const bool along_x = p.radius_x > 0 || p.radius_y == 0;
  const int radius = along_x ? p.radius_x : p.radius_y;
  // Rows of the input lie radius_y above and below those of the output.
  const int in_first = (at.z * p.rows_in + p.radius_y) * p.width;
  const int out_first = at.z * p.rows * p.width;
  if (along_x) {
    if (at.y >= p.rows || at.x * kRun >= p.width) return;
    const int begin = at.x * kRun;
    const int end = min(begin + kRun, p.width);
    const int line = in_first + at.y * p.width;
    float sum = 0.0;
    for (int x = max(begin - radius, 0); x < min(begin + radius, p.width); ++x) sum += texelFetch(distances, line + x).x;
    for (int x = begin; x < end; ++x) {
      if (x + radius < p.width) sum += texelFetch(distances, line + x + radius).x;
      sums.data[out_first + at.y * p.width + x] = sum;
      if (x - radius >= 0) sum -= texelFetch(distances, line + x - radius).x;
    }
  } else {
    if (at.x >= p.width || at.y * kRun >= p.rows) return;
    const int begin = at.y * kRun;
    const int end = min(begin + kRun, p.rows);
    const int column = in_first + at.x;
    float sum = 0.0;
    for (int y = begin - radius; y < begin + radius; ++y) sum += texelFetch(distances, column + y * p.width).x;
    for (int y = begin; y < end; ++y) {
      sum += texelFetch(distances, column + (y + radius) * p.width).x;
      sums.data[out_first + y * p.width + at.x] = sum;
      sum -= texelFetch(distances, column + (y - radius) * p.width).x;
    }
  }
}
