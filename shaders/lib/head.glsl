// A layer of 1x1 on the features of a pixel. The including kernel has the constant `planes`, of four features each, and the texel
// buffers `features` and `weights`, and says by kMostOutputs how many outputs there are at most. `weights` has for each output a
// vector a plane, then all biases, four in a vector. They are copied to shared memory and read from there at literal offsets,
// outside of all branches, as lib/convolution.glsl explains.

shared vec4 head_weights[planes * kMostOutputs + (kMostOutputs + 3) / 4];

/// To be called by all invocations, before anything else.
void load_head(int outputs) {
  const int count = planes * outputs + (outputs + 3) / 4;
  const int invocations = int(gl_WorkGroupSize.x * gl_WorkGroupSize.y);
  for (int i = int(gl_LocalInvocationIndex); i < count; i += invocations) head_weights[i] = texelFetch(weights, i);
  barrier();
}

/// The outputs of the pixel `index` of images of `pixels`.
void apply_head(int outputs, int index, int pixels, out float values[kMostOutputs]) {
  [[unroll]] for (int o = 0; o < outputs; ++o) values[o] = head_weights[outputs * planes + o / 4][o % 4];
  [[unroll]] for (int g = 0; g < planes; ++g) {
    const vec4 f = texelFetch(features, g * pixels + index);
    [[unroll]] for (int o = 0; o < outputs; ++o) values[o] += dot(head_weights[o * planes + g], f);
  }
}
