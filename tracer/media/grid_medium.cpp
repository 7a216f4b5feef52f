#include "tracer/media/grid_medium.h"

namespace becalm::tracer {

M44f world_to_voxels(const M44d& medium_to_world, const V3i& voxels) {
  M44d box_to_voxels;
  for (int a = 0; a < 3; ++a) box_to_voxels[a][a] = box_to_voxels[3][a] = 0.5 * (voxels[a] - 1);
  return M44f(medium_to_world.inverse() * box_to_voxels);
}

namespace {

/// The tentative collisions of a ray with the medium, in order: a Poisson process whose rate is the majorant.
/// collide(t, share) gets the distance and the density's share of the majorant there, in [0,1], and returns
/// whether to go on. One exponential number lasts across blocks, since the process has no memory.
template <class Collide>
void visit_tentative_collisions(const GridMedium& medium, const V3f& origin, const V3f& dir, float t_max,
                                MediumRandom& random, const Collide& collide) {
  const DensityGrid& grid = *medium.density;
  if (grid.largest() == 0.0f) return;
  const V3f dir_voxels = transform_vector(dir, medium.world_to_voxels);
  const GridSpan span =
      clip_to_grid(grid, transform_point(origin, medium.world_to_voxels), dir_voxels, t_max);
  const float extinction =
      std::min(medium.extinction, kLargestDepthPerVoxel * dir_voxels.length() / grid.largest());
  float depth = random.next_exponential();
  visit_blocks(grid, span, [&](const V3i& block, float majorant, float t_in, float t_out) {
    const float rate = extinction * majorant;
    float t = t_in;
    while (depth < rate * (t_out - t)) {
      t += depth / rate;
      const float density = grid.density_in_block(block, span.origin + dir_voxels * t);
      if (!collide(span.offset + t, density / majorant)) return false;
      depth = random.next_exponential();
    }
    depth -= rate * (t_out - t);
    return true;
  });
}

/// Below this an estimate of transmittance is kept with a probability, or ends as 0.
constexpr float kRouletteBelow = 0.1f;

}  // namespace

float transmittance(const GridMedium& medium, const V3f& origin, const V3f& dir, float t_max,
                    MediumRandom& random) {
  float result = 1.0f;
  visit_tentative_collisions(medium, origin, dir, t_max, random, [&](float, float share) {
    result *= 1.0f - share;
    if (result >= kRouletteBelow) return true;
    if (random.next() * kRouletteBelow >= result) {
      result = 0.0f;
      return false;
    }
    result = kRouletteBelow;
    return true;
  });
  return result;
}

MediumSample sample_distance(const GridMedium& medium, const V3f& origin, const V3f& dir, float t_max,
                             MediumRandom& random) {
  MediumSample sample{false, t_max, V3f(1.0f)};
  visit_tentative_collisions(medium, origin, dir, t_max, random, [&](float t, float share) {
    if (random.next() >= share) return true;
    sample = {true, std::min(t, t_max), medium.albedo};
    return false;
  });
  return sample;
}

}  // namespace becalm::tracer
