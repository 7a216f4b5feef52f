// A 1x1 layer on the features of a pixel. The including kernel defines the constant `planes` (of four
// features each), the texel buffers `features` and `weights`, and kMostOutputs, the largest number of
// outputs. `weights` holds for each output one vector per plane, then all biases, four in a vector. They are
// copied to shared memory and read there at literal offsets, outside of all branches
// (lib/convolution_weights.glsl says why).

shared vec4 head_weights[planes * kMostOutputs + (kMostOutputs + 3) / 4];

/// All invocations must call this before anything else.
void load_head(int outputs) {
  const int count = planes * outputs + (outputs + 3) / 4;
  const int invocations = int(gl_WorkGroupSize.x * gl_WorkGroupSize.y);
  for (int i = int(gl_LocalInvocationIndex); i < count; i += invocations) head_weights[i] = texelFetch(weights, i);
  barrier();
}

/// The outputs for pixel `index` of an image of `pixels` pixels.
void apply_head(int outputs, int index, int pixels, out float values[kMostOutputs]) {
  [[unroll]] for (int o = 0; o < outputs; ++o) values[o] = head_weights[outputs * planes + o / 4][o % 4];
  [[unroll]] for (int g = 0; g < planes; ++g) {
    const vec4 f = texelFetch(features, g * pixels + index);
    [[unroll]] for (int o = 0; o < outputs; ++o) values[o] += dot(head_weights[o * planes + g], f);
  }
}
