// Subpixel minimum of a quadric through 3x3 costs (Hanika et al. 2021, section 3.1; fit as in Hasinoff et al. 2016).
#include "lib/language.glsl"

/// Least-squares fit of c + b.x + x.A.x/2 to the 3x3 costs, row-major from (-1,-1). True if the fit has a minimum within
/// one pixel of the centre, which `x` and `y` then are; false leaves them 0. The test for a minimum compares the
/// determinant with the product of the diagonal, so that it does not depend on the costs' scale.
bool quadric_minimum(float c00, float c10, float c20, float c01, float c11, float c21, float c02, float c12, float c22,
                     OUT(float) x, OUT(float) y) {
  x = 0.0f;
  y = 0.0f;
  float axx = 0.25f * ((c00 - 2.0f * c10 + c20) + 2.0f * (c01 - 2.0f * c11 + c21) + (c02 - 2.0f * c12 + c22));
  float ayy = 0.25f * ((c00 - 2.0f * c01 + c02) + 2.0f * (c10 - 2.0f * c11 + c12) + (c20 - 2.0f * c21 + c22));
  float axy = 0.25f * ((c00 - c20) - (c02 - c22));
  float bx = 0.125f * ((c20 - c00) + 2.0f * (c21 - c01) + (c22 - c02));
  float by = 0.125f * ((c02 - c00) + 2.0f * (c12 - c10) + (c22 - c20));
  float det = axx * ayy - axy * axy;
  if (!(axx > 0.0f) || !(ayy > 0.0f) || !(det > 1e-3f * axx * ayy)) return false;
  float mx = (axy * by - ayy * bx) / det;
  float my = (axy * bx - axx * by) / det;
  if (!(mx * mx + my * my <= 1.0f)) return false;
  x = mx;
  y = my;
  return true;
}
