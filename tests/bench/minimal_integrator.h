#pragma once

#include "tracer/path_trace.h"

namespace becalm::bench {

/// A path tracer written by hand for scenes of plain diffuse triangles that stand still while the shutter is
/// open: what the tracer's "diffuse" variant would be had nobody thought of anything else. Draws the same
/// random numbers, so that both must give the same image.
tracer::PathSample minimal_path(const tracer::PathContext& context, const tracer::V2f& raster,
                                tracer::Sampler& sampler);

/// It as a variant to render with.
inline constexpr tracer::PathVariant kMinimalVariant{"minimal", false, false,        false,
                                                     false,     false, &minimal_path};

}  // namespace becalm::bench
