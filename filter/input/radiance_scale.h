#pragma once

#include "frame/frame.h"

namespace becalm::filter {

/// The power of two that brings the frame's luminances nearer to 1, if most of those that count are so far
/// from 1 that squares of radiance would leave the range of floats; else, and for a black frame, 1. The
/// filter is exactly invariant to it. It depends on the frame alone, so that all jobs and all passes over a
/// frame have the same.
float radiance_scale(const Frame& frame);

/// Multiplies radiance by a power of two, and variances by its square, in all AOVs that are either. What
/// would leave the range of floats becomes its largest value; NaN and Inf stay. Where the variance came from
/// beyond that range, as 0 or denormal in dim frames and the largest value in bright ones, it is taken from
/// the half-buffers or, without them, is the square of the radiance.
void scale_radiance(Frame& frame, float scale);

/// Scales what was made of `source`, scaled, back. Pixels of radiance with NaN or Inf, which the filter
/// leaves as they are, get the values of `source`, since their other channels may have been out of range in
/// between.
void scale_radiance_back(Frame& made, float scale, const Frame& source);

}  // namespace becalm::filter
