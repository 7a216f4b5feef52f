// Reads the new frame's pixels with their confidence, and the warped history. Writes for each tile of kTile^2 pixels
// the light of the frame and of the history, summed over the pixels that both have and weighted by confidence: (colour,
// weight) of each. The sums are divided by kTile^2, so that their squares stay within the range of floats.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/antialias_params.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 color_size; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer warped_color;
layout(set = 0, binding = 3) uniform samplerBuffer warped_stats;
layout(std430, set = 0, binding = 4) writeonly buffer FrameBuffer { vec4 data[]; } of_frame;
layout(std430, set = 0, binding = 5) writeonly buffer HistoryBuffer { vec4 data[]; } of_history;

#include "lib/squared.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  vec4 frame = vec4(0.0);
  vec4 history = vec4(0.0);
  const ivec2 end = min(kTile * (at + 1), color_size);
  for (int y = kTile * at.y; y < end.y; ++y) {
    for (int x = kTile * at.x; x < end.x; ++x) {
      const int tap = y * color_size.x + x;
      const float w = texelFetch(warped_stats, tap).y > 0.0 ? texelFetch(variance, tap).y : 0.0;
      if (w <= 0.0) continue;
      frame += w * vec4(limited(texelFetch(color, tap).rgb), 1.0);
      history += w * vec4(limited(texelFetch(warped_color, tap).rgb), 1.0);
    }
  }
  const int index = at.y * size.x + at.x;
  of_frame.data[index] = frame / float(kTile * kTile);
  of_history.data[index] = history / float(kTile * kTile);
}
