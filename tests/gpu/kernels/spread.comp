// Made in bands: wide = (x, 2x, 3x, x of the row below), sum += x, and copy = x if there is one.
#version 460
layout(local_size_x = 64) in;
layout(constant_id = 0) const int has_copy = 0;
layout(push_constant) uniform Params { ivec2 size; ivec2 narrow_size; int first_row; int factor; };
layout(set = 0, binding = 0) uniform samplerBuffer narrow;
layout(std430, set = 0, binding = 1) writeonly buffer WideBuffer { vec4 data[]; } wide;
layout(std430, set = 0, binding = 2) buffer SumBuffer { vec2 data[]; } sum;
layout(std430, set = 0, binding = 3) writeonly buffer CopyBuffer { float data[]; } copy;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  if (at.x >= size.x || at.y >= size.y) return;
  const int below = min(at.y + 1, narrow_size.y - 1) * narrow_size.x + at.x;
  const float x = float(factor) * texelFetch(narrow, at.y * size.x + at.x).x;
  const int written = (at.y - first_row) * size.x + at.x;
  wide.data[written] = vec4(x, 2.0 * x, 3.0 * x, float(factor) * texelFetch(narrow, below).x);
  sum.data[written] += vec2(x, -x);
  if (has_copy != 0) copy.data[written] = x;
}
