// scaled = +-(gain + half_steps / 2) fine + bias, by specialization constants.
#version 460
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 3) const int bias = 10;
layout(constant_id = 1) const int gain = 1;
layout(constant_id = 2) const int negate = 0;
layout(constant_id = 0) const int half_steps = 0;
layout(push_constant) uniform Params { int width; int height; } p;
layout(std430, set = 0, binding = 1) readonly buffer FineBuffer { float data[]; } fine;
layout(std430, set = 0, binding = 0) writeonly buffer ScaledBuffer { float data[]; } scaled;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID);
  if (at.x >= p.width || at.y >= p.height) return;
  const int i = at.y * p.width + at.x;
  const float factor = float(gain) + 0.5 * float(half_steps);
  scaled.data[i] = (negate != 0 ? -factor : factor) * fine.data[i] + float(bias);
}
