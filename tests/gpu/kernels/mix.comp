// Reads two buffers of any sizes, one of them as texels, writes one: whole numbers mixed so that every element tells which elements made it.
#version 460
layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { int width; int height; int planes; int a_count; int b_count; uint salt; } p;
layout(std430, set = 0, binding = 0) readonly buffer ABuffer { uint data[]; } a;
layout(set = 0, binding = 1) uniform usamplerBuffer b;
layout(std430, set = 0, binding = 2) writeonly buffer ResultBuffer { uint data[]; } result;

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height || at.z >= p.planes) return;
  const int i = (at.z * p.height + at.y) * p.width + at.x;
  result.data[i] = 3u * a.data[(i + 7) % p.a_count] + 5u * texelFetch(b, (i + 31) % p.b_count).x + p.salt;
}
