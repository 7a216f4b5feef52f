#pragma once

// The functions of shaders/lib/ as C++: the text that the kernels include, compiled with the few GLSL names
// that C++ lacks.

#include <algorithm>
#include <cmath>

namespace becalm::glsl {
using std::abs;
using std::clamp;
using std::exp;
using std::log2;
using std::max;
using std::min;
using std::sqrt;

#include "shaders/lib/color.glsl"     // NOLINT(bugprone-suspicious-include)
#include "shaders/lib/distance.glsl"  // NOLINT(bugprone-suspicious-include)
#include "shaders/lib/gain.glsl"      // NOLINT(bugprone-suspicious-include)
#include "shaders/lib/mosaic.glsl"    // NOLINT(bugprone-suspicious-include)
#include "shaders/lib/quadric.glsl"   // NOLINT(bugprone-suspicious-include)
#include "shaders/lib/resample.glsl"  // NOLINT(bugprone-suspicious-include)
}  // namespace becalm::glsl
