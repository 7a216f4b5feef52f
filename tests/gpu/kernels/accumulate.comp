// Adds `term` to `sum`, element by element.
#version 460
layout(local_size_x = 64) in;
layout(push_constant) uniform Params { int count; } p;
layout(std430, set = 0, binding = 0) readonly buffer TermBuffer { float data[]; } term;
layout(std430, set = 0, binding = 1) restrict buffer SumBuffer { float data[]; } sum;

void main() {
  const int i = int(gl_GlobalInvocationID.x);
  if (i < p.count) sum.data[i] += term.data[i];
}
