#pragma once

namespace becalm::gpu {

/// Distances in pixels from the four sides of a rectangle.
struct Margin {
  int left = 0;
  int above = 0;
  int right = 0;
  int below = 0;

  bool operator==(const Margin&) const = default;
};

/// Which pixels of an image a pass reads for one pixel that it writes: by default the one at the same place.
/// Positions outside of the image mean its border. Footprints say what results depend on: a value that counts
/// with weight 0 is not part of them. Made by the functions below.
struct Footprint {
  enum class Kind {
    local,     ///< a rectangle around the pixel
    gathered,  ///< anything within `around` of the pixel's place in the source rectangle of a tile
    anywhere,  ///< any pixel
  };

  Kind kind = Kind::local;
  Margin around = {};  ///< in pixels of the image that is read or of that written, whichever are smaller
  int covered = 1;     ///< side of the square of pixels of the image that one written pixel covers
  int covering = 1;    ///< side of the square of written pixels that one pixel of the image covers
  int run_rows = 1;    ///< as in_runs_of

  bool operator==(const Footprint&) const = default;
};

constexpr Footprint reach(int x, int y) {
  return {.around = {.left = x, .above = y, .right = x, .below = y}};
}

constexpr Footprint reach(int px) {
  return reach(px, px);
}

/// The factor x factor pixels that the written pixel covers, and `around` pixels around them.
constexpr Footprint block(int factor, int around = 0) {
  Footprint footprint = reach(around);
  footprint.covered = factor;
  return footprint;
}

/// Pixels of an image that is `factor` times smaller: those that cover the written pixel and `around` written
/// pixels around it.
constexpr Footprint coarser(int factor, int around) {
  Footprint footprint = reach(around);
  footprint.covering = factor;
  return footprint;
}

/// A bilinear read of an image that is `factor` times smaller, at most `displacement` written pixels away.
constexpr Footprint bilinear(int factor, int displacement = 0) {
  return coarser(factor, displacement + factor / 2);
}

/// A read at offsets from the pixel's place in the source rectangle; `around` bounds the offsets and the
/// filter's taps together.
constexpr Footprint gather(int around) {
  Footprint footprint = reach(around);
  footprint.kind = Footprint::Kind::gathered;
  return footprint;
}

/// A read of a table that is the same in all tiles. Chains give it to what Chain::table declared and fills
/// wrote.
constexpr Footprint anywhere() {
  return {.kind = Footprint::Kind::anywhere};
}

/// The footprint of a pass that computes runs of `rows` rows from top to bottom, the first of which begins in
/// row 0: a pixel also depends on what the pixels above it in its run read.
constexpr Footprint in_runs_of(int rows, Footprint footprint) {
  footprint.run_rows = rows;
  return footprint;
}

}  // namespace becalm::gpu
