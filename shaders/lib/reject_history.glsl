// What rejects a history: patches that the aligner found to differ, and a filtered difference of colour. Not pure
// functions: the including kernel declares the texel buffers residual, difference and difference_sums.

/// Of the inverted mask (Hanika et al. 2021, section 4): patches whose distance exceeds kEta / kKappa differ.
const float kKappa = 40.0;
const float kEta = 0.2;
/// Filtered difference, relative to the brightness, that rejects the whole history, and below which none is.
const float kRejects = 0.3;
const float kAccepts = 0.05;
const int kRejectionRadius = 3;

/// 1 where patches differ, 0 where they are alike.
float mask_of(ivec2 at) {
  const BilinearTaps taps = bilinear_taps(at, vec2(p.edge_x, p.edge_y), residual_size, p.residual_scale);
  return clamp(kKappa * bilinear_value(residual, taps, residual_size.x, 0) - kEta, 0.0, 1.0);
}

/// The least weight of the new frame by the filtered difference (survey, eq. 5).
float least_by_color(ivec2 at, int index) {
  vec4 sum = texelFetch(difference_sums, index);
  float count = 0.0;
  [[unroll]] for (int i = -kRejectionRadius; i <= kRejectionRadius; ++i) {
    const bool inside = at.x + i >= 0 && at.x + i < size.x;
    const vec4 tap = texelFetch(difference, inside ? index + i : index);
    sum += inside ? tap : vec4(0.0);
    count += inside ? 1.0 : 0.0;
  }
  const int rows = min(at.y + kRejectionRadius, size.y - 1) - max(at.y - kRejectionRadius, 0) + 1;
  const vec3 mean = abs(sum.rgb) / (count * float(rows));
  return clamp((max(mean.r, max(mean.g, mean.b)) - kAccepts) / (kRejects - kAccepts), 0.0, 1.0);
}
