// Reads two buffers of any sizes, one of them as texels, writes one: whole numbers below kModulus, mixed so that every element tells which elements made it.
#version 460
layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { int width; int height; int planes; int a_count; int b_count; int salt; } p;
layout(std430, set = 0, binding = 0) readonly buffer ABuffer { float data[]; } a;
layout(set = 0, binding = 1) uniform samplerBuffer b;
layout(std430, set = 0, binding = 2) writeonly buffer ResultBuffer { float data[]; } result;

const int kModulus = 65521;  // kMixModulus of tests/gpu/support.h

void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height || at.z >= p.planes) return;
  const int i = (at.z * p.height + at.y) * p.width + at.x;
  const int of_a = int(a.data[(i + 7) % p.a_count]);
  const int of_b = int(texelFetch(b, (i + 31) % p.b_count).x);
  result.data[i] = float((3 * of_a + 5 * of_b + p.salt) % kModulus);
}
