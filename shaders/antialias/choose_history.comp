// Reads the new frame and its history as two kinds of offsets bring it: by motion vectors and by the search;
// writes the one that resembles the frame more over 3x3 pixels, and its offsets. Vectors are exact, a search errs by parts of
// a pixel: the history by vectors stays unless the other one's squared difference is clearly smaller, as
// where a shadow or a reflection moves on a surface that does not.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "lib/squared.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer vectors_color;
layout(set = 0, binding = 2) uniform samplerBuffer vectors_stats;
layout(set = 0, binding = 3) uniform samplerBuffer search_color;
layout(set = 0, binding = 4) uniform samplerBuffer search_stats;
layout(set = 0, binding = 5) uniform samplerBuffer variance;
layout(std430, set = 0, binding = 6) writeonly buffer WarpedColorBuffer { vec4 data[]; } warped_color;
layout(std430, set = 0, binding = 7) writeonly buffer WarpedStatsBuffer { vec2 data[]; } warped_stats;
layout(set = 0, binding = 8) uniform samplerBuffer vectors_offset;
layout(set = 0, binding = 9) uniform samplerBuffer search_offset;
layout(std430, set = 0, binding = 10) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

/// Of the squared difference of the vectors' history, so much must be left of the search's.
const float kClearly = 0.25;
/// Variances of the frame that the vectors' squared difference must exceed.
const float kBeyond = 3.0;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  float of_vectors = 0.0;
  float of_search = 0.0;
  float noise = 0.0;
  [[unroll]] for (int k = 0; k < 9; ++k) {
    const ivec2 q = at + ivec2(k % 3, k / 3) - 1;
    const bool inside = q.x >= 0 && q.y >= 0 && q.x < size.x && q.y < size.y;
    const int tap = inside ? q.y * size.x + q.x : index;
    const vec3 x = texelFetch(color, tap).rgb;
    const bool both = texelFetch(vectors_stats, tap).y > 0.0 && texelFetch(search_stats, tap).y > 0.0;
    of_vectors += both ? squared(x - texelFetch(vectors_color, tap).rgb) : 0.0;
    of_search += both ? squared(x - texelFetch(search_color, tap).rgb) : 0.0;
    noise += both ? texelFetch(variance, tap).x : 0.0;
  }
  const vec2 stats_v = texelFetch(vectors_stats, index).xy;
  const vec2 stats_s = texelFetch(search_stats, index).xy;
  const bool searched = stats_v.y <= 0.0 || (stats_s.y > 0.0 && of_vectors > kBeyond * noise && of_search < kClearly * of_vectors);
  warped_color.data[index] = searched ? texelFetch(search_color, index) : texelFetch(vectors_color, index);
  warped_stats.data[index] = searched ? stats_s : stats_v;
  offset.data[index] = (searched ? texelFetch(search_offset, index) : texelFetch(vectors_offset, index)).xy;
}
