#pragma once

#include "tracer/path_trace.h"

namespace becalm::bench {

/// A path tracer written by hand for diffuse triangles that do not move while the shutter is open: the least
/// code that the tracer's "diffuse" variant could be. It draws the same random numbers, so both give the same
/// image.
tracer::PathSample minimal_path(const tracer::PathContext& context, const tracer::V2f& raster,
                                tracer::Sampler& sampler);

/// minimal_path as a variant of the integrator.
inline constexpr tracer::PathVariant kMinimalVariant{"minimal", false, false, false, false, &minimal_path};

}  // namespace becalm::bench
