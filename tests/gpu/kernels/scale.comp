// scaled = +-(gain + half_steps / 2) fine + bias: one specialization constant of each type.
#version 460
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 3) const int bias = 10;
layout(constant_id = 1) const float gain = 1.0;
layout(constant_id = 2) const bool negate = false;
layout(constant_id = 0) const uint half_steps = 0u;
layout(push_constant) uniform Params { int width; int height; } p;
layout(std430, set = 0, binding = 1) readonly buffer FineBuffer { float data[]; } fine;
layout(std430, set = 0, binding = 0) writeonly buffer ScaledBuffer { float data[]; } scaled;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height) return;
  const int i = at.y * p.width + at.x;
  const float factor = gain + 0.5 * float(half_steps);
  scaled.data[i] = (negate ? -factor : factor) * fine.data[i] + float(bias);
}
