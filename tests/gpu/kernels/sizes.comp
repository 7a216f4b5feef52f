// Writes the sizes that the chain supplies, and a constant of the pass.
#version 460
layout(local_size_x = 4, local_size_y = 4) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 fine_size; ivec2 absent_size; ivec2 found_size; int term; };
layout(set = 0, binding = 0) uniform samplerBuffer fine;
layout(set = 0, binding = 1) uniform samplerBuffer absent;
layout(std430, set = 0, binding = 2) writeonly buffer FoundBuffer { float data[]; } found;

void main() {
  if (gl_GlobalInvocationID.xy != uvec2(0)) return;
  const int all[9] = int[](size.x, size.y, fine_size.x, fine_size.y, absent_size.x, absent_size.y, found_size.x, found_size.y, term);
  for (int i = 0; i < 9; ++i) found.data[i] = float(all[i]);
}
