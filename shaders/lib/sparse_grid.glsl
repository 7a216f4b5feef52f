// The 3x3 samples around a pixel. Not pure functions: the including kernel declares the constant `sparse`, `size` of
// the pixels, and the texel buffers columns and rows (filter/antialias/sample_grid.h), which are read if samples and
// pixels are not of one grid.

struct GridTaps {
  ivec2 nearest;  // the sample in the middle
  mat3 narrow;    // weights of the pixel filter, [column][row]
  mat3 wide;      // of the filter that finds samples everywhere; 0 beyond the pixel's neighbourhood
};

GridTaps grid_taps(ivec2 at) {
  if (sparse == 0) return GridTaps(at, mat3(0.0), mat3(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0));
  const vec4 x = texelFetch(columns, at.x);
  const vec4 y = texelFetch(rows, at.y);
  return GridTaps(ivec2(x.x, y.x), outerProduct(y.yzw, x.yzw),
                  outerProduct(texelFetch(rows, size.y + at.y).yzw, texelFetch(columns, size.x + at.x).yzw));
}
