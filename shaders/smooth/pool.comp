// Reads an image of any number of planes; writes the maximum of each 2x2 pixels, channel by channel, at half
// the size, rounded up. An invocation makes one pixel of one plane: dispatch the extent of the coarse image.
#version 460
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 32, local_size_y = 4) in;
layout(push_constant) uniform Sizes { ivec2 fine_size; };
layout(set = 0, binding = 0) uniform samplerBuffer fine;
layout(std430, set = 0, binding = 1) writeonly buffer CoarseBuffer { vec4 data[]; } coarse;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  const int plane = int(gl_GlobalInvocationID.z);
  const ivec2 size = (fine_size + 1) / 2;
  if (at.x >= size.x || at.y >= size.y) return;
  const ivec2 next = min(2 * at + 1, fine_size - 1);
  const int row = (plane * fine_size.y + 2 * at.y) * fine_size.x;
  const int next_row = (plane * fine_size.y + next.y) * fine_size.x;
  const vec4 above = max(texelFetch(fine, row + 2 * at.x), texelFetch(fine, row + next.x));
  const vec4 below = max(texelFetch(fine, next_row + 2 * at.x), texelFetch(fine, next_row + next.x));
  coarse.data[(plane * size.y + at.y) * size.x + at.x] = max(above, below);
}
