// Reads an antialiased frame and one number; writes the frame sharpened that much. Contrast-adaptive as in
// AMD's FidelityFX CAS (Kramer 2019, in the survey of Yang et al. 2020, section 6.1.2): the weight of the four
// neighbours falls with the local contrast, and the result stays within the range of the 3x3 pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer amount;  // in [0,1]
layout(std430, set = 0, binding = 2) writeonly buffer SharpenedBuffer { vec4 data[]; } sharpened;

/// Negative weight of each neighbour where there is no contrast, at full amount.
const float kMost = 0.2;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  vec4 low = vec4(3.4e38);
  vec4 high = vec4(-3.4e38);
  vec4 cross = vec4(0.0);
  [[unroll]] for (int k = 0; k < 9; ++k) {
    const ivec2 q = clamp(at + ivec2(k % 3, k / 3) - 1, ivec2(0), size - 1);
    const vec4 x = texelFetch(color, q.y * size.x + q.x);
    low = min(low, x);
    high = max(high, x);
    cross += k % 2 == 1 ? 0.25 * x : vec4(0.0);
  }
  const vec4 here = texelFetch(color, index);
  // Zero next to black, where a full range leaves no room.
  const vec3 room = sqrt(clamp(low.rgb / max(high.rgb, vec3(1e-30)), 0.0, 1.0));
  const float weight = 4.0 * kMost * texelFetch(amount, 0).x * min(room.r, min(room.g, room.b));
  const vec3 result = here.rgb + weight / (1.0 - weight) * (here.rgb - cross.rgb);
  sharpened.data[index] = vec4(clamp(result, low.rgb, high.rgb), here.a);
}
