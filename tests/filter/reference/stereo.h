#pragma once

#include "tests/filter/reference/merge.h"

namespace becalm::reference {

/// An eye's estimate blended with the other eye's at the same pixels, in mode `smoothed` or not.
/// `weights` becomes the other eye's.
Grid<Estimate> blend_eyes(const Grid<Estimate>& own, const Grid<Estimate>& other, double exposure, int radius,
                          bool smoothed, Grid<double>& weights);

/// What is known of a pixel's place in the other eye's image.
struct EyeCandidate {
  Vec2 search;
  double of_depth = 1e30;       ///< 1e30: not known
  double expected_depth = 0.0;  ///< 0: not known
};

/// The offset into the other eye's image; 1e6 in both components where the other eye does not see the pixel.
/// Features are those of both images.
Grid<Vec2> choose_offsets(const Grid<EyeCandidate>& candidates, const Grid<double>& own,
                          const Grid<double>& other, const Grid<double>& other_depth);

}  // namespace becalm::reference
