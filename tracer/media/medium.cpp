#include "tracer/media/medium.h"

namespace becalm::tracer {

MediumSample sample_distance(const Medium& medium, const V3f& origin, const V3f& dir, float t_max,
                             MediumRandom& random, const V3f& throughput) {
  if (const auto* grid = std::get_if<GridMedium>(&medium)) {
    return sample_distance(*grid, origin, dir, t_max, random);
  }
  return sample_distance(std::get<HomogeneousMedium>(medium), t_max, random, throughput);
}

std::optional<float> sample_absorption(const Medium& medium, float t_max, MediumRandom& random,
                                       const V3f& throughput) {
  const auto* homogeneous = std::get_if<HomogeneousMedium>(&medium);
  return homogeneous ? sample_absorption(*homogeneous, t_max, random, throughput) : std::nullopt;
}

V3f transmittance(const Medium& medium, const V3f& origin, const V3f& dir, float t_max,
                  MediumRandom& random) {
  if (const auto* grid = std::get_if<GridMedium>(&medium)) {
    return V3f(transmittance(*grid, origin, dir, t_max, random));
  }
  return transmittance(std::get<HomogeneousMedium>(medium), t_max);
}

float mean_cosine(const Medium& medium) {
  return std::visit([](const auto& m) { return m.g; }, medium);
}

std::size_t bytes(const Medium& medium) {
  const auto* grid = std::get_if<GridMedium>(&medium);
  return grid == nullptr ? 0 : grid->bytes();
}

}  // namespace becalm::tracer
