// Takes RGBA apart: luminance-like sum of four and the first two channels. No push constants.
#version 460
layout(local_size_x = 16) in;
layout(std430, set = 0, binding = 0) readonly buffer ColorBuffer { vec4 data[]; } color;
layout(std430, set = 0, binding = 1) writeonly buffer SumBuffer { float data[]; } sum;
layout(std430, set = 0, binding = 2) writeonly buffer FirstBuffer { vec2 data[]; } first;

void main() {
  const int i = int(gl_GlobalInvocationID.x);
  if (i >= color.data.length()) return;
  const vec4 c = color.data[i];
  sum.data[i] = c.x + c.y + c.z + c.w;
  first.data[i] = c.xy;
}
