// Writes a factor of one: the correction that is coarser than the coarsest.
#version 460

layout(local_size_x = 1, local_size_y = 1) in;
layout(std430, set = 0, binding = 0) writeonly buffer FactorBuffer { vec4 data[]; } factor;

void main() { factor.data[0] = vec4(1.0); }
