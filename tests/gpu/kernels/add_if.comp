// sum = a, and b besides if there is one; the same again in `copy` if anyone wants it.
#version 460
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int has_b = 0;
layout(constant_id = 1) const int has_copy = 0;
layout(push_constant) uniform Params { int width; int height; } p;
layout(set = 0, binding = 0) uniform samplerBuffer a;
layout(set = 0, binding = 1) uniform samplerBuffer b;
layout(std430, set = 0, binding = 2) writeonly buffer SumBuffer { float data[]; } sum;
layout(std430, set = 0, binding = 3) writeonly buffer CopyBuffer { float data[]; } copy;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height) return;
  const int i = at.y * p.width + at.x;
  float value = texelFetch(a, i).x;
  if (has_b != 0) value += texelFetch(b, i).x;
  sum.data[i] = value;
  if (has_copy != 0) copy.data[i] = value;
}
