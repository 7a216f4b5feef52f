// Mean over the pixels that one pixel of a smaller image covers. The including kernel enables
// GL_EXT_control_flow_attributes.

/// Mean of the `factor` x `factor` pixels of a plane that pixel `at` covers, as far as they lie in the image.
float block_mean(samplerBuffer image, ivec2 at, int plane, ivec2 size, int factor) {
  float sum = 0.0;
  float count = 0.0;
  [[unroll]] for (int j = 0; j < factor; ++j) {
    [[unroll]] for (int i = 0; i < factor; ++i) {
      const ivec2 q = at * factor + ivec2(i, j);
      const bool inside = factor == 1 || all(lessThan(q, size));
      const ivec2 tap = min(q, size - 1);
      sum += inside ? texelFetch(image, (plane * size.y + tap.y) * size.x + tap.x).x : 0.0;
      count += inside ? 1.0 : 0.0;
    }
  }
  return sum / count;
}
