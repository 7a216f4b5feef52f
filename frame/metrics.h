#pragma once

#include "frame/image.h"

namespace becalm {

/// Every metric below compares the first three channels (or the only one) of images of equal size, and skips,
/// in all images alike, pixels where any of them is not finite; `skipped` tells how many, and the value is
/// NaN if none is left. Sums are in double. Mismatched sizes and empty images throw std::invalid_argument.
struct Measured {
  double value = 0.0;
  std::size_t skipped = 0;
};

/// Mean over pixels and channels of (x-r)^2 / (r^2 + 0.01).
Measured rel_mse(const Image& test, const Image& reference);

/// Two independent references a, b: mean of (x-a)(x-b) / (((a+b)/2)^2 + 0.01). A relative variance s^2 of
/// each adds about 1.5 s^4, by the denominator, where one reference alone adds s^2. May be slightly negative
/// for an image as good as the references.
Measured rel_mse(const Image& test, const Image& reference_a, const Image& reference_b);

/// relMSE of frame differences: (x_t - x_{t-1}) against (r_t - r_{t-1}), over (r_t^2 + r_{t-1}^2)/2 + 0.01.
Measured temporal_error(const Image& test, const Image& test_before, const Image& reference,
                        const Image& reference_before);
/// The same in the product form of two independent references, whose noise takes about 0.5 s^4.
Measured temporal_error(const Image& test, const Image& test_before, const Image& reference_a,
                        const Image& reference_a_before, const Image& reference_b,
                        const Image& reference_b_before);

/// mean(x)/mean(r) - 1, and 0 for black against black; two references are averaged.
Measured energy(const Image& test, const Image& reference);
Measured energy(const Image& test, const Image& reference_a, const Image& reference_b);

/// Peak signal to noise ratio in dB with the given peak; two references use the product form of the squared
/// error. Infinite where the error is zero or, in the product form, below.
Measured psnr(const Image& test, const Image& reference, double peak = 1.0);
Measured psnr(const Image& test, const Image& reference_a, const Image& reference_b, double peak);

/// Structural similarity (Wang et al. 2004: 11x11 Gaussian of sigma 1.5, K1 = 0.01, K2 = 0.03) of the
/// luminances after clamping to [0,1] and the sRGB curve, so that it agrees with what published tables
/// compute on display images. The mean over whole windows; where the image is smaller than a window, over
/// what there is of it. Pixels that are not finite have no weight in their neighbours' windows.
Measured ssim(const Image& test, const Image& reference);
/// Two independent references a, b: the reference's variance is their covariance, which their noise does not
/// add to. A window may be slightly above 1.
Measured ssim(const Image& test, const Image& reference_a, const Image& reference_b);

}  // namespace becalm
