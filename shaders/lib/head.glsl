// A 1x1 layer on the features of the `strip` pixels, below one another, that an invocation computes. The
// including kernel defines the constants `planes` (of four features each), `strip` and `framed`, the texel
// buffers `features` and `weights`, and kMostOutputs, the largest number of outputs. `features` are planes or, if
// `framed`, pixels with all their features and a pixel more on each side. `weights` holds for each output
// one vector per plane, then all biases, four in a vector. They are copied to shared memory and read there at
// literal offsets, outside of all branches (lib/convolution_weights.glsl says why).

shared vec4 head_weights[planes * kMostOutputs + (kMostOutputs + 3) / 4];

/// All invocations must call this before anything else.
void load_head(int outputs) {
  const int count = planes * outputs + (outputs + 3) / 4;
  const int invocations = int(gl_WorkGroupSize.x * gl_WorkGroupSize.y);
  for (int i = int(gl_LocalInvocationIndex); i < count; i += invocations) head_weights[i] = texelFetch(weights, i);
  barrier();
}

int index_of_features(int plane, ivec2 at, ivec2 image_size) {
  const int in_frame = ((at.y + 1) * (image_size.x + 2) + at.x + 1) * planes + plane;
  return framed != 0 ? in_frame : (plane * image_size.y + at.y) * image_size.x + at.x;
}

/// Output o of pixel s is head[s * kMostOutputs + o]. A global, since an array of specialized size cannot be a
/// parameter.
float head[strip * kMostOutputs];

/// Sets `head` for the strip that begins at `first`, of an image of this size.
void apply_head(int outputs, ivec2 first, ivec2 image_size) {
  vec4 f[strip * planes];
  [[unroll]] for (int s = 0; s < strip; ++s) {
    const int row = min(first.y + s, image_size.y - 1);
    [[unroll]] for (int g = 0; g < planes; ++g) {
      f[s * planes + g] = texelFetch(features, index_of_features(g, ivec2(first.x, row), image_size));
    }
  }
  [[unroll]] for (int o = 0; o < outputs; ++o) {
    [[unroll]] for (int s = 0; s < strip; ++s) head[s * kMostOutputs + o] = head_weights[outputs * planes + o / 4][o % 4];
    [[unroll]] for (int g = 0; g < planes; ++g) {
      const vec4 w = head_weights[o * planes + g];
      [[unroll]] for (int s = 0; s < strip; ++s) head[s * kMostOutputs + o] += dot(w, f[s * planes + g]);
    }
  }
}

/// Turns the first `logits` outputs of each pixel into weights of a softmax, but for their sum: the largest is 1.
void apply_softmax(int logits) {
  [[unroll]] for (int s = 0; s < strip; ++s) {
    const int from = s * kMostOutputs;
    float largest = head[from];
    [[unroll]] for (int t = 1; t < logits; ++t) largest = max(largest, head[from + t]);
    [[unroll]] for (int t = 0; t < logits; ++t) head[from + t] = exp(head[from + t] - largest);
  }
}
