// Subpixel minimum of a quadric through 3x3 costs (Hanika et al. 2021, section 3.1; fit as in Hasinoff et al. 2016).
#include "lib/language.glsl"

/// Fits c + b.x + x.A.x/2 to the 3x3 costs, row-major from (-1,-1), by least squares with weights
/// (1,2,1)x(1,2,1). Returns true if the fit has a minimum within one pixel of the centre and sets `x` and `y`
/// to it, else to 0. The scale of the costs does not matter. A hundredth of the larger curvature is added to
/// the diagonal, which selects the nearest point of a valley (an edge fixes one direction only). Curvatures
/// up to `rounding` are ignored.
bool quadric_minimum(float c00, float c10, float c20, float c01, float c11, float c21, float c02, float c12, float c22,
                     float rounding, OUT(float) x, OUT(float) y) {
  x = 0.0f;
  y = 0.0f;
  float axx = 0.25f * ((c00 - 2.0f * c10 + c20) + 2.0f * (c01 - 2.0f * c11 + c21) + (c02 - 2.0f * c12 + c22));
  float ayy = 0.25f * ((c00 - 2.0f * c01 + c02) + 2.0f * (c10 - 2.0f * c11 + c12) + (c20 - 2.0f * c21 + c22));
  float axy = 0.25f * ((c00 - c20) - (c02 - c22));
  float bx = 0.125f * ((c20 - c00) + 2.0f * (c21 - c01) + (c22 - c02));
  float by = 0.125f * ((c02 - c00) + 2.0f * (c12 - c10) + (c22 - c20));
  float larger = max(axx, ayy);
  if (!(larger > rounding)) return false;
  axx += 0.01f * larger;
  ayy += 0.01f * larger;
  float det = axx * ayy - axy * axy;
  if (!(axx > 0.0f) || !(ayy > 0.0f) || !(det > 0.0f)) return false;
  float mx = (axy * by - ayy * bx) / det;
  float my = (axy * bx - axx * by) / det;
  if (!(mx * mx + my * my <= 1.0f)) return false;
  x = mx;
  y = my;
  return true;
}

/// Largest subpixel offset along one axis that the costs allow. `here` is the pixel's cost, `before` and
/// `after` are its neighbours'; a perfect match costs 0. An image displaced by m costs about |m| times as
/// much as one displaced by a whole pixel (m^2 times under L2). So a perfect match has no subpixel part,
/// however uneven its surroundings; noise raises `here` and with it the limit.
float subpixel_limit(float here, float before, float after, bool squared) {
  float ratio = here / max(0.5f * (before + after), 1e-30f);
  return min(squared ? sqrt(ratio) : ratio, 1.0f);
}
