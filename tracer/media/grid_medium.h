#pragma once

#include <cstddef>
#include <memory>

#include "tracer/math/vec.h"
#include "tracer/media/cloud_shape.h"
#include "tracer/media/density_grid.h"
#include "tracer/media/medium_random.h"
#include "tracer/media/medium_sample.h"

namespace becalm::tracer {

/// A density that varies over the unit box [-1,1]^3 of the medium's own space, empty outside.
///
/// Rays are given in world space. Their parameter t stays a distance in world units on the way to voxels,
/// since the map is affine, and extinction is per world unit: a medium stretched by its object's transform
/// gets longer and not thinner.
struct GridMedium {
  /// Usually in [0,1]. Media of one shape share it.
  std::shared_ptr<const DensityGrid> density = std::make_shared<const DensityGrid>();
  M44f world_to_voxels;      ///< affine
  float extinction = 0.0f;   ///< per scene unit where the density is 1; the same for all channels; [0, 1e30]
  V3f albedo{0.0f};          ///< of a single scattering, in [0,1]
  float g = 0.0f;            ///< mean cosine of the phase function, in (-1,1)
  CloudShape baked_shape{};  ///< what `density` was made from

  std::size_t bytes() const { return density->bytes(); }
};

/// From world space to voxel coordinates, for a medium whose box [-1,1]^3 is placed by `medium_to_world`,
/// which must be invertible.
M44f world_to_voxels(const M44d& medium_to_world, const V3i& voxels);

/// Where the mean free path at the grid's largest density would be shorter than 1/256 of a voxel, the
/// extinction is reduced to that, along each ray. Below a voxel the density is a straight line by definition,
/// so that only the faintest fringe of such a medium passes light that it should not; without this bound, a
/// ray at an extinction of 1e30 would take 1e30 steps in the thin edge of a block.
inline constexpr float kLargestDepthPerVoxel = 256.0f;

/// Unbiased estimate of the share of the radiance that passes from origin to origin + t_max dir, `dir` of
/// unit length, t_max in [0, inf]: 0 to 1, the same for all channels. Ratio tracking (Novak, Selle and
/// Jarosz, "Residual Ratio Tracking for Estimating Attenuation in Participating Media", 2014, section 3),
/// with Russian roulette once the estimate is small. Ends with the span's blocks, and in each block because
/// every step goes on by an exponential distance, on average 1 / majorant: see kLargestDepthPerVoxel.
float transmittance(const GridMedium& medium, const V3f& origin, const V3f& dir, float t_max,
                    MediumRandom& random);

/// Draws the distance to the next scattering in [0, t_max) by delta tracking (Woodcock et al. 1965), or none.
/// The weight is the albedo, or 1. Ends as transmittance() does.
MediumSample sample_distance(const GridMedium& medium, const V3f& origin, const V3f& dir, float t_max,
                             MediumRandom& random);

}  // namespace becalm::tracer
