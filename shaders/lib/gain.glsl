// The merge's scalar estimation problem (Philippi et al., eq. 4 and 5).
#include "lib/language.glsl"

/// Limit of a relative difference, which keeps sums of its square within the range of floats.
const float kLargestDifference = 1e9f;

/// Largest effective number of frames in a history. A longer one gains little and follows slow changes late.
const float kMostFrames = 64.0f;

/// How far the noise that a pixel takes from its neighbours may exceed its own, as a standard deviation in
/// units of the pixel's luminance or the frame's typical luminance, whichever is more. Sky beside the disc of
/// the sun is not as noisy as the disc's edge.
const float kLargestBorrowedNoise = 32.0f;

/// The variance of a pixel's neighbours, limited to what the pixel may have: `light` is the pixel's luminance
/// or the frame's typical one, whichever is more.
float borrowed_variance(float of_neighbours, float own, float light) {
  float borrowed = kLargestBorrowedNoise * light;
  return min(of_neighbours, own + borrowed * borrowed);
}

/// Part of a squared quantity that noise does not explain: `measured` less `noise` and less `standard_errors`
/// standard errors, which are those of a noise estimate over `count` pixels of Gaussian noise.
float excess_over_noise(float measured, float noise, float count, float standard_errors) {
  return max(0.0f, measured - noise * (1.0f + standard_errors * sqrt(2.0f / count)));
}

/// Standard errors by which a residual of noisy frames must exceed noise to count as bias; below that, noise
/// would reject history.
const float kSignificanceInNoise = 3.0f;

/// By what the expected error of a smoothed frame is multiplied before unshared_part compares it with the noise. On
/// held-out shots a factor of 1 gains as much but loses 4 % at 128 samples a pixel, and 10 gains a fifth less.
const float kBlurInError = 4.0f;

/// Part of a smoothed frame's expected squared `error` that differs from frame to frame, if the noisy frame has the
/// variance `noise`: where the error comes near to the noise, the smoother has blurred rather than averaged. Two
/// renders of one frame differ, squared, by 0.4 of that error on average, but by 0.15 where it exceeds the noise.
float unshared_part(float error, float noise) { return noise > 0.0f ? noise / (noise + kBlurInError * error) : 0.0f; }

/// Squared bias in a squared difference d of smoothed frames whose errors alone make `expected` of it on
/// average: d times the cube of d / (d + expected), the gain of a Wiener filter. A part of every d counts,
/// since most misaligned detail differs by less than `expected`. With the gain itself instead of its cube,
/// the differences of frames that match would keep their history short.
float smoothed_bias(float squared_difference, float expected) {
  float total = squared_difference + expected;
  float share = total > 0.0f ? squared_difference / total : 0.0f;
  return squared_difference * share * share * share;
}

/// Squared bias of a patch of `count` pixels, whose differences have the expected square `noise`. Noisy frames: what
/// all pixels share shows in the mean difference (`mean_squared`), whose noise averages out; misaligned detail shows in
/// the mean squared difference (`squared_mean`) alone. Noise is taken as grey: the squared mean then has one degree of
/// freedom, whatever the number of channels. If the new frame is `smoothed`, errors of neighbours are alike, so that
/// their mean tells no more than their square.
float patch_bias(float mean_squared, float squared_mean, float noise, float count, bool smoothed) {
  if (smoothed) return smoothed_bias(squared_mean, noise);
  return max(excess_over_noise(mean_squared, noise / count, 1.0f, kSignificanceInNoise),
             excess_over_noise(squared_mean, noise, count, kSignificanceInNoise));
}

/// Weight of the new sample that minimises the expected squared error, eq. 4. `variance_new` is that of the
/// new sample's mean; `variance_history` and `bias_squared` are the history's.
float gain(float variance_new, float variance_history, float bias_squared) {
  float history_error = variance_history + bias_squared;
  float total = history_error + variance_new;
  // Both are exact: take the new sample, which is certainly of this frame.
  return total > 0.0f ? history_error / total : 1.0f;
}

/// Effective sample count after blending one new frame with weight `alpha` into a history of `n` frames, eq. 5, and no
/// more than kMostFrames.
float blended_count(float n, float alpha) {
  float count = n > 0.0f ? n / (alpha * alpha * n + (1.0f - alpha) * (1.0f - alpha)) : 1.0f;
  return min(count, kMostFrames);
}
