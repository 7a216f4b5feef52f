#pragma once

#include <array>
#include <vector>

#include "frame/frame.h"

namespace becalm::filter {

/// What a frame shows, coarsely: means over cells of pixels, of which noise has little left.
struct ShotSignature {
  /// Range-compressed luminance, albedo's luminance, normal; 0 where the frame has none or nothing finite.
  using Cell = std::array<float, 5>;

  int columns = 0;
  int rows = 0;
  bool guides = false;  ///< whether albedo or normals are there to compare by
  std::vector<Cell> cells;
};

/// `used` are the AOVs to look at, of those that the frame has; `exposure` is the frame's.
ShotSignature shot_signature(const Frame& frame, const AovSet& used, float exposure);

/// Whether a cut lies between two frames, of which it does not matter which is the first: too many cells of
/// one look like no cell nearby in the other. Compares albedo and normals where there are any, which light
/// that changes leaves alone, and else the luminance.
bool is_cut(const ShotSignature& a, const ShotSignature& b);

}  // namespace becalm::filter
