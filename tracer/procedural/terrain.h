#pragma once

#include <Imath/ImathBox.h>

#include <optional>
#include <vector>

#include "tracer/procedural/description.h"
#include "tracer/procedural/height_pyramid.h"
#include "tracer/procedural/point.h"
#include "tracer/procedural/spline_patch.h"
#include "tracer/procedural/terrain_noise.h"

namespace becalm::tracer {

/// Mountains at one frame: a biquadratic B-spline surface through baked noise. Its controls stand at the
/// cells' centres and one ring around.
class Terrain {
 public:
  /// Bakes again only if the noise differs from what is baked; another height or size is a scale. Returns
  /// whether the surface changed.
  bool update(const TerrainDescription& description, double frame);

  Imath::Box3f bounds() const;
  std::optional<float> intersect(const V3f& origin, const V3f& dir, float t_min, float t_max) const;
  ProceduralPoint point(const V3f& p, float footprint) const;
  V3f point_before(const V3f& p) const;
  std::size_t bytes() const;

 private:
  /// Controls of a spline of `resolution` cells a side, and the mean of the squared slopes (both axes) of the
  /// finest spline over each cell, in heights per side.
  struct Level {
    int resolution = 0;
    std::vector<float> controls;
    std::vector<float> squared_slope;

    std::size_t stride() const { return static_cast<std::size_t>(resolution) + 2; }
  };
  /// Slopes and what averaging took from them, in heights per side.
  struct Averaged {
    float slope_x, slope_z, squared_slope;
  };

  void bake();
  void bake_ranges();
  void bake_coarser(const Level& fine, Level& coarse);
  Imath::Box3f unit_bounds() const;
  HeightSlope heights_at(const Level& level, float x, float z) const;
  Averaged averaged_at(const Level& level, float x, float z) const;
  Averaged averaged_at(float x, float z, float footprint) const;

  double size_ = 1.0;
  float scale_ = 0.0f;         ///< height in sizes
  float scale_before_ = 0.0f;  ///< a frame before
  float tolerance_ = 0.0f;
  TerrainShape shape_{};
  std::vector<Level> levels_;  ///< finest first
  HeightPyramid pyramid_;
};

}  // namespace becalm::tracer
