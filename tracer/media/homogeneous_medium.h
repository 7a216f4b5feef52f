#pragma once

#include <optional>

#include "tracer/math/vec.h"
#include "tracer/media/medium_random.h"
#include "tracer/media/medium_sample.h"

namespace becalm::tracer {

/// The same everywhere. Each channel scatters and absorbs by itself.
struct HomogeneousMedium {
  V3f extinction{0.0f};  ///< per scene unit, in [0, 1e30]
  V3f albedo{0.0f};      ///< of a single scattering, in [0,1]
  float g = 0.0f;        ///< mean cosine of the phase function, in (-1,1)

  bool operator==(const HomogeneousMedium&) const = default;
};

/// Share of the radiance that passes `distance` in [0, inf]. Exact: 1 without extinction, at any distance.
V3f transmittance(const HomogeneousMedium& medium, float distance);

/// Draws the distance to the next scattering, or none before `t_max` in [0, inf]. The distance follows the
/// extinction of one channel, chosen in proportion to the path's throughput, and the density is that of the
/// mixture over channels (the balance heuristic over channels; Fong et al., "Production volume rendering",
/// SIGGRAPH courses 2017, section 4), so that throughput times weight never exceeds the throughput's sum in
/// any channel. A medium that only absorbs gives its transmittance, without noise. A throughput that is black
/// or not finite counts as white.
MediumSample sample_distance(const HomogeneousMedium& medium, float t_max, MediumRandom& random,
                             const V3f& throughput);

/// Where light is absorbed before `t_max` in a medium that only absorbs, drawn as sample_distance() does for
/// one that hardly scatters; nothing in others.
std::optional<float> sample_absorption(const HomogeneousMedium& medium, float t_max, MediumRandom& random,
                                       const V3f& throughput);

}  // namespace becalm::tracer
