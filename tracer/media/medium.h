#pragma once

#include <optional>
#include <variant>

#include "tracer/media/grid_medium.h"
#include "tracer/media/homogeneous_medium.h"
#include "tracer/media/phase.h"

// What fills the inside of an object. Rays are in world space: `dir` has unit length, and t_max in [0, inf]
// is the distance to where the ray leaves the object. A path that scatters goes on with
// sample_henyey_greenstein().

namespace becalm::tracer {

using Medium = std::variant<HomogeneousMedium, GridMedium>;

/// Draws the distance to the next scattering, or none before t_max. `throughput` is the path's.
MediumSample sample_distance(const Medium& medium, const V3f& origin, const V3f& dir, float t_max,
                             MediumRandom& random, const V3f& throughput);

/// Where the light along the ray is absorbed before t_max in a homogeneous medium that only absorbs and so
/// never gives a scattering; nothing in others.
std::optional<float> sample_absorption(const Medium& medium, float t_max, MediumRandom& random,
                                       const V3f& throughput);

/// Unbiased estimate of the share of the radiance that passes t_max: exact for a homogeneous medium, which
/// takes no random numbers.
V3f transmittance(const Medium& medium, const V3f& origin, const V3f& dir, float t_max, MediumRandom& random);

/// Of the phase function.
float mean_cosine(const Medium& medium);

/// Memory beyond the Medium itself.
std::size_t bytes(const Medium& medium);

}  // namespace becalm::tracer
