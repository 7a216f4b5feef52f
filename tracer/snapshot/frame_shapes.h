#pragma once

#include <span>
#include <vector>

#include "tracer/scene/geometry.h"

namespace becalm::tracer {

/// The shapes of a scene's geometries at a moment, in frames. Meshes are referred to; procedural
/// surfaces are kept here and made anew only where their parameters have changed. FrameShapes stay valid and
/// keep their addresses from frame to frame.
class FrameShapes {
 public:
  /// The geometries must outlive this.
  FrameShapes(std::span<const Geometry> geometries, double frame);

  const Shape& operator[](std::size_t geometry) const { return shapes_[geometry]; }
  const Imath::Box3f& bounds(std::size_t geometry) const { return bounds_[geometry]; }

  /// Returns the geometries whose shape has changed.
  std::vector<std::size_t> set_frame(double frame);

  /// Memory of the procedural surfaces.
  std::size_t procedural_bytes() const;

 private:
  std::span<const Geometry> geometries_;
  std::vector<Procedural> procedurals_;  ///< in the geometries' order
  std::vector<Shape> shapes_;
  std::vector<Imath::Box3f> bounds_;
};

}  // namespace becalm::tracer
