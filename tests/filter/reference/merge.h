#pragma once

#include <array>

#include "filter/settings.h"
#include "tests/filter/reference/grid.h"

namespace becalm::reference {

using Rgba = std::array<double, 4>;

inline double luminance(const Rgba& c) {
  return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

/// A pixel's estimate: its value, the remaining variance, and its effective sample count (0: no data).
struct Estimate {
  Rgba color{};
  double variance = 0.0;
  double count = 0.0;
};

struct Merged {
  Grid<Estimate> estimate;
  Grid<double> rejected;
};

/// A sharp filter's unlimited result at a position of the image whose taps are given.
Rgba read_sharp(const Grid<Rgba>& taps, double x, double y);

/// The history warped to the target's pixels: variance and count are read bilinearly, the colour by the
/// filter, limited to the range of the four nearest pixels by one share for all channels.
Grid<Estimate> warp(const Grid<Estimate>& history, const Grid<Vec2>& offset, filter::Resample resample);

/// The squared bias of a patch of `count` pixels: the square of its mean difference and its mean square, less
/// what noise explains. Of a smoothed frame the square alone counts, by the cube of a Wiener filter's gain.
double patch_bias(double mean_square, double square, double noise, double count, bool smoothed);

/// The squared difference of a sample from its history that their variances explain. Of smoothed frames
/// nothing, or if the variance of the noisy frame is known (smooth=merged), what of their errors is not blur.
double explained_square(const Estimate& sample, const Estimate& history, filter::Smooth smooth,
                        double noisy_variance);

/// Variance gain (Philippi et al., eq. 4) with the bias estimated from the residuals of leave-one-out
/// patches; a smoothed sample's own variance is used if it is less than its patch's. The sample's count is 1,
/// or 0 for a non-finite pixel. `noisy` is the frame before it was smoothed, which smooth=merged reads.
Merged merge_by_variance(const Grid<Estimate>& sample, const Grid<Estimate>& warped, double exposure,
                         const filter::Settings& settings, const Grid<Estimate>& noisy = {});

/// A noisy layer whose variance is lowered to what differs from the warped history: a squared difference,
/// scaled to one frame's noise, over the variance; that of the pixel or of those within 3 px around it,
/// whichever is more, and at most 1.
Grid<Estimate> known_noise(const Grid<Estimate>& noisy, const Grid<Estimate>& warped, double exposure);

/// The paper's rejection by the patch distance at full resolution.
Merged merge_by_mask(const Grid<Estimate>& sample, const Grid<Estimate>& warped,
                     const Grid<double>& residual);

}  // namespace becalm::reference
