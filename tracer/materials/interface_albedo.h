#pragma once

#include "tracer/materials/albedo_table.h"

namespace becalm::tracer {

/// What a rough clear interface reflects and refracts of uniform light after one scattering on its GGX
/// microsurface, seen from one side. Tables of each index of refraction are integrated when first asked for.
class InterfaceAlbedo {
 public:
  /// `n` is the index of refraction on the other side over that on this one.
  InterfaceAlbedo(float alpha, float n);

  /// At a cosine in [0,1].
  float at(float cosine) const;

  /// Mean over the hemisphere, weighed by the cosine.
  float mean() const;

 private:
  struct Slice;
  static const Slice& slice(int index);

  const Slice& below_;  ///< of the next smaller index among the nodes
  const Slice& above_;
  TablePosition alpha_;
  float fraction_;  ///< of the way from below_ to above_
};

/// Share of uniform light that a smooth interface lets through from that side (Walsh 1926; in this form
/// Duntley, "The Optical Properties of Diffusing Materials", 1942).
float mean_fresnel_transmittance(float n);

}  // namespace becalm::tracer
