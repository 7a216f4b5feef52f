#pragma once

#include "tests/filter/reference/grid.h"

namespace becalm {

/// A smooth random pattern on the plane, defined between pixels too, so that shifted images have an exact
/// truth: three octaves of value noise with wavelengths of 6, 24 and 96 px, in [0,1].
double pattern(double x, double y, unsigned seed);

/// The pattern's pixels at (x, y) + shift.
reference::Grid<double> pattern_image(int width, int height, reference::Vec2 shift, unsigned seed);

}  // namespace becalm
