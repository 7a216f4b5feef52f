// How the weights of a window's pixels are stored: `kShiftsPerPlane` of 8 bits in each value of a plane, shifts row by row.
const int kShiftsPerPlane = 4;

/// Shift number `i` of a window of that radius.
ivec2 window_shift(int i, int radius) {
  const int side = 2 * radius + 1;
  return ivec2(i % side - radius, i / side - radius);
}
