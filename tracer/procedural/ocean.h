#pragma once

#include <Imath/ImathBox.h>

#include <optional>

#include "tracer/procedural/description.h"
#include "tracer/procedural/height_pyramid.h"
#include "tracer/procedural/point.h"
#include "tracer/procedural/spline_patch.h"

namespace becalm::tracer {

/// Trains are summed in lanes: `count` is a multiple of kTrainLanes, filled up with flat trains.
inline constexpr int kTrainLanes = 8;

/// Plane waves: height = sum of amplitude sin(2 pi (kx x + kz z + phase)), all in units of the ocean's side.
struct WaveTrains {
  int count = 0;
  alignas(16) float kx[kMostTrains];  ///< turns a side
  alignas(16) float kz[kMostTrains];
  alignas(16) float amplitude[kMostTrains];
  alignas(16) float phase[kMostTrains];  ///< turns in [0, 1)
};

/// The trains of an ocean at a time. Wavelengths divide the given range evenly in their logarithm, jittered;
/// their energies follow the spectrum of Pierson and Moskowitz (1964) in the form S(w) ~ w^-5 exp(-5/4
/// (w_peak/w)^4), scaled to the significant height; angular frequencies are deep water's, w^2 = g k.
WaveTrains make_wave_trains(const OceanDescription& description, double frame);

/// The ocean at one frame. Rays are marched against the sum of all trains itself; what is baked are ranges of
/// its height over cells, to skip where a ray is clear of the water.
class Ocean {
 public:
  /// Returns whether the surface changed.
  bool update(const OceanDescription& description, double frame);

  Imath::Box3f bounds() const;
  std::optional<float> intersect(const V3f& origin, const V3f& dir, float t_min, float t_max) const;
  ProceduralPoint point(const V3f& p, float footprint) const;
  V3f point_before(const V3f& p) const;
  std::size_t bytes() const { return pyramid_.bytes(); }

 private:
  void bake_ranges(int resolution);
  Imath::Box3f unit_bounds() const;
  /// From object space to [0,1] along a side.
  float unit(float v) const;

  double size_ = 1.0;
  WaveTrains trains_;
  WaveTrains trains_before_;  ///< a frame before
  HeightPyramid pyramid_;
};

}  // namespace becalm::tracer
