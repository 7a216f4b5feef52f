#pragma once

#include <array>
#include <vector>

#include "frame/frame.h"

namespace becalm::filter {

/// A coarse description of a frame: means over cells of pixels, in which little noise remains.
struct ShotSignature {
  /// Range-compressed luminance, albedo's luminance, normal; 0 where the frame has no such AOV or no finite
  /// value. The luminance of a cell without known radiance, such as outside of the data window, is NaN.
  using Cell = std::array<float, 5>;

  int columns = 0;
  int rows = 0;
  bool guides = false;  ///< whether cells have albedo or normals to compare
  std::vector<Cell> cells;
};

/// Reads those AOVs of the frame that are in `used`; `exposure` is the frame's.
ShotSignature shot_signature(const Frame& frame, const AovSet& used, float exposure);

/// Whether any cell has known radiance. A frame of NaN alone does not, and cannot be compared.
bool has_known_cells(const ShotSignature& signature);

/// Whether there is a cut between two frames, given in any order: too many cells of one have no similar cell
/// nearby in the other, of those that are known in both. Compares albedo and normals if there are any, since
/// changing light does not affect them, else the luminance.
bool is_cut(const ShotSignature& a, const ShotSignature& b);

}  // namespace becalm::filter
