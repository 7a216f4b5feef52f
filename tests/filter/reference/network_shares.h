#pragma once

#include "filter/smooth/weights.h"
#include "tests/filter/reference/network.h"

namespace becalm::reference {

struct Restored {
  Grid<Estimate> result;
  Grid<double> patch_noise;  ///< mean variance around each pixel, relative to the squared brightness
};

/// Puts back the part of the sample that patches lost beyond their noise. `features` are those of the frame
/// itself.
Restored restored(const Grid<Estimate>& sample, const Grid<Estimate>& smoothed,
                  const Grid<SmoothFeatures>& features, double exposure);

/// The mean of the smoothed merged frame and the frame itself, by the layers' share.
Grid<Estimate> with_own_share(const TwoSamples& samples, const Restored& restored,
                              const filter::OwnShareWeights& layers, double exposure);

}  // namespace becalm::reference
