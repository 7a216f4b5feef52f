// The inverted mask of Hanika et al. 2021, section 4: history is averaged only where patches differ. Not a pure
// function: the including kernel declares the texel buffer residual and includes lib/bilinear.glsl.

/// Patches whose distance exceeds kEta / kKappa differ.
const float kKappa = 40.0;
const float kEta = 0.2;

/// 1 where patches differ, 0 where they are alike.
float mask_of(ivec2 at) {
  const BilinearTaps taps = bilinear_taps(at, vec2(p.edge_x, p.edge_y), residual_size, p.residual_scale);
  return clamp(kKappa * bilinear_value(residual, taps, residual_size.x, 0) - kEta, 0.0, 1.0);
}
