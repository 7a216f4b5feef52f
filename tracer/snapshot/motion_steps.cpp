#include "tracer/snapshot/motion_steps.h"

namespace becalm::tracer {

namespace {

constexpr int kMostSegments = 128;   // as many as Embree takes
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

/// Times in [0,1] of the shutter's interval at which the curve may bend or turn back.
std::vector<double> times_of_keys(const TransformCurve& curve, double frame, const Shutter& shutter) {
  std::vector<double> times;
  for (const TransformCurve::Key& key : curve.keys()) {
    const double time = (key.frame - shutter.at(frame, 0.0)) / (shutter.close - shutter.open);
    if (time > 0.0 && time < 1.0) times.push_back(time);
  }
  return times;
}

/// Largest distance between the curve and its steps relative to the object's size, at the given times and at
/// eight times in each segment. Half of those are not evenly spaced: at evenly spaced times alone, whole
/// turns would look like rest.
double error(const TransformCurve& curve, double frame, const Shutter& shutter, int segments, double radius,
             std::vector<double> times) {
  const MotionSteps<double> steps = motion_steps(curve, frame, shutter, segments);
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 4 * segments; ++i) {
    for (const double offset : {0.0, golden}) times.push_back((i + offset) / (4.0 * segments));
  }
  double worst = 0.0;
  for (const double time : times) {
    const M44d exact = transform_at(curve, shutter.at(frame, time));
    worst = std::max(
        worst, distance(exact, steps.at(static_cast<float>(time)), radius) / linear_size(exact, radius));
  }
  return worst;
}

}  // namespace

int motion_segments(const TransformCurve& curve, double frame, const Shutter& shutter, double radius) {
  if (!shutter.blurs() || !curve.animated()) return 0;
  const std::vector<double> times = times_of_keys(curve, frame, shutter);
  // Values are monotone between keys: if they agree at the keys and at both ends, nothing moves.
  const TransformCurve::Value first = curve.at(shutter.at(frame, 0.0));
  const auto same = [&](double time) { return curve.at(shutter.at(frame, time)) == first; };
  if (same(1.0) && std::ranges::all_of(times, same)) return 0;
  int segments = 1;
  while (segments < kMostSegments && error(curve, frame, shutter, segments, radius, times) > kTolerance)
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
