#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "frame/mosaic.h"

namespace becalm::filter {

/// A colour at a place between the pixels of a mosaic is a weighted sum of the samples around it. `kCfaTaps`
/// pixels a side take part, from `kCfaBefore` before the pixel at or before the place; the place is rounded
/// to `kCfaSteps` a pixel.
constexpr int kCfaTaps = 6;
constexpr int kCfaBefore = 2;
constexpr int kCfaSteps = 16;

/// The number of weights of a pattern.
constexpr std::size_t cfa_weight_count(const CfaPattern& cfa) {
  return std::size_t{kCfaTaps} * kCfaTaps * 3 * kCfaSteps * kCfaSteps * cfa.period * cfa.period;
}

/// Weights for each pixel of the pattern, each step of the place within it down and right, and each of red,
/// green and blue, in this order (the last varies fastest), then those of the window, row-major.
/// `white_balance` makes grey of white light.
///
/// They are the best linear unbiased estimate (universal kriging: Matheron 1963) of white-balanced colours
/// that differ by distance^1.8 in the mean square, and by a fifth more where samples of one colour are
/// compared. Even areas of any colour are exact. A sample at the place itself has weight 1.
std::vector<float> cfa_weights(const CfaPattern& cfa, const std::array<float, 3>& white_balance);

}  // namespace becalm::filter
