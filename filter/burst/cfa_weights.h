#pragma once

#include <vector>

#include "frame/mosaic.h"

namespace becalm::filter {

/// How the colours that a pixel of a mosaic lacks are estimated from samples of that colour around it: the
/// weights of a plane fitted by least squares, closer samples counting more.
struct CfaWeights {
  int reach = 0;  ///< of the samples: 1 for Bayer's pattern, 2 for X-Trans
  /// For each pixel of the pattern, row-major, and each of red, green and blue: the weights of the pixels
  /// around it, row-major. They add up to 1. A pixel's own colour has weight 1 at its centre.
  std::vector<float> values;

  int side() const { return 2 * reach + 1; }
};

CfaWeights cfa_weights(const CfaPattern& cfa);

}  // namespace becalm::filter
