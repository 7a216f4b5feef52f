#include "tracer/motion_steps.h"

namespace becalm::tracer {

namespace {

constexpr int kMostSegments = 32;
constexpr double kTolerance = 1e-3;  ///< of the radius

/// Bound of how far apart the two put a point within `radius` of the origin.
double distance(const M44d& a, const M44d& b, double radius) {
  double sum = 0.0;
  for (int column = 0; column < 3; ++column) {
    double linear = 0.0;
    for (int row = 0; row < 3; ++row) linear += std::abs(a[row][column] - b[row][column]);
    const double d = linear * radius + std::abs(a[3][column] - b[3][column]);
    sum += d * d;
  }
  return std::sqrt(sum);
}

/// Size of a ball of that radius after the linear part.
double linear_size(const M44d& m, double radius) {
  double largest = 0.0;
  for (int row = 0; row < 3; ++row)
    largest = std::max(largest, V3d(m[row][0], m[row][1], m[row][2]).length());
  return largest * radius;
}

/// Largest distance between the curve and its steps between their times, relative to the object's size.
double error(const TransformCurve& curve, double frame, const Shutter& shutter, int segments, double radius) {
  const MotionSteps<double> steps = motion_steps(curve, frame, shutter, segments);
  double worst = 0.0;
  for (int i = 0; i < 4 * segments; ++i) {
    const double time = i / (4.0 * segments);
    const M44d exact = transform_at(curve, shutter.at(frame, time));
    worst = std::max(
        worst, distance(exact, steps.at(static_cast<float>(time)), radius) / linear_size(exact, radius));
  }
  return worst;
}

}  // namespace

int motion_segments(const TransformCurve& curve, double frame, const Shutter& shutter, double radius) {
  if (!shutter.blurs() || !curve.animated()) return 0;
  const M44d first = transform_at(curve, shutter.at(frame, 0.0));
  bool moves = false;
  for (int i = 1; i <= 4 && !moves; ++i) moves = transform_at(curve, shutter.at(frame, i / 4.0)) != first;
  if (!moves) return 0;
  int segments = 1;
  while (segments < kMostSegments && error(curve, frame, shutter, segments, radius) > kTolerance)
    segments *= 2;
  return segments;
}

MotionSteps<double> motion_steps(const TransformCurve& curve, double frame, const Shutter& shutter,
                                 int segments) {
  std::vector<M44d> steps;
  for (int i = 0; i <= segments; ++i) {
    steps.push_back(
        transform_at(curve, shutter.at(frame, segments > 0 ? static_cast<double>(i) / segments : 0.5)));
  }
  return MotionSteps<double>(std::move(steps));
}

}  // namespace becalm::tracer
