#pragma once

#include "tests/filter/reference/merge.h"

namespace becalm::reference {

/// An eye's estimate blended with the other eye's at the same pixels, of frames that are smoothed so;
/// `noisy_variance` is that of the own eye without smoothing (smooth=merged). `weights` becomes the other
/// eye's.
Grid<Estimate> blend_eyes(const Grid<Estimate>& own, const Grid<Estimate>& other, double exposure, int radius,
                          filter::Smooth smooth, const Grid<double>& noisy_variance, Grid<double>& weights);

/// The offsets into the other eye's image; 1e6 in both components where the other eye does not see the pixel:
/// no pixel around the place has the expected depth (0: not known).
Grid<Vec2> checked_offsets(const Grid<Vec2>& offsets, const Grid<double>& expected_depth,
                           const Grid<double>& other_depth);

}  // namespace becalm::reference
