#pragma once

#include <algorithm>
#include <vector>

#include "tracer/scene/shutter.h"
#include "tracer/scene/transform.h"

namespace becalm::tracer {

/// Transforms at equally spaced times from the shutter's opening to its closing, linear between them, as
/// Embree interpolates the motion of instances. A single one if nothing moves in that time.
template <class T>
class MotionSteps {
 public:
  using Matrix = Imath::Matrix44<T>;
  MotionSteps() : steps_(1) {}
  explicit MotionSteps(std::vector<Matrix> steps) : steps_(std::move(steps)) {}

  bool moving() const { return steps_.size() > 1; }
  const std::vector<Matrix>& steps() const { return steps_; }
  const Matrix& first() const { return steps_.front(); }

  Matrix at(float time) const {
    if (!moving()) return steps_.front();
    const T scaled = static_cast<T>(time) * static_cast<T>(steps_.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(scaled), steps_.size() - 2);
    const T f = scaled - static_cast<T>(i);
    return steps_[i] * (T(1) - f) + steps_[i + 1] * f;
  }

 private:
  std::vector<Matrix> steps_;
};

/// The number of segments, at most 128, with which linear motion keeps every point within `radius` of the
/// object's origin within a thousandth of the object's size of its exact place; 0 if nothing moves while the
/// shutter is open.
int motion_segments(const TransformCurve& curve, double frame, const Shutter& shutter, double radius);

MotionSteps<double> motion_steps(const TransformCurve& curve, double frame, const Shutter& shutter,
                                 int segments);

}  // namespace becalm::tracer
