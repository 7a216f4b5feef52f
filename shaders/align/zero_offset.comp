// Writes the offset field of one pixel from which the coarsest level starts: no motion.
#version 460

layout(local_size_x = 1) in;
layout(std430, set = 0, binding = 0) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

void main() { offset.data[0] = vec2(0.0); }
