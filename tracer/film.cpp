#include "tracer/film.h"

namespace becalm::tracer {

namespace {

/// Variances of radiances beyond 1e19 do not fit into float; they become its largest value instead of
/// infinity.
float to_float(double v) {
  constexpr double largest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(v, -largest, largest));
}

template <class Vec>
void store(Frame& frame, Aov aov, int x, int y, const Vec& value) {
  if (!frame.has(aov)) return;
  const std::span<float> pixel = frame.image(aov).pixel(x, y);
  for (unsigned c = 0; c < Vec::dimensions(); ++c) pixel[c] = to_float(value[c]);
}

}  // namespace

V3d PixelStatistics::variance_of_mean() const {
  const double n = count_;
  // One sample says nothing about its spread. Its square is the second moment's estimate and so at least the
  // variance on average: too much noise is assumed rather than none.
  return count_ >= 2 ? squares_ / (n * (n - 1.0)) : mean_ * mean_;
}

void PixelStatistics::write(Frame& frame, int x, int y) const {
  const double weight = count_ > 0 ? 1.0 / count_ : 0.0;
  store(frame, Aov::beauty, x, y, Imath::Vec4<double>(mean_.x, mean_.y, mean_.z, covered_ * weight));
  store(frame, Aov::variance, x, y, variance_of_mean());
  store(frame, Aov::half_a, x, y, half_count_[0] > 0 ? half_sum_[0] / half_count_[0] : V3d(0.0));
  store(frame, Aov::half_b, x, y, half_count_[1] > 0 ? half_sum_[1] / half_count_[1] : V3d(0.0));
  store(frame, Aov::albedo, x, y, count_ > 0 ? albedo_ * weight : V3d(1.0));
  store(frame, Aov::normal, x, y, normal_ * weight);
  store(frame, Aov::motion, x, y, motion_ * weight);
  if (frame.has(Aov::depth)) {
    frame.image(Aov::depth).at(x, y, 0) =
        depth_count_ > 0 ? to_float(depth_ / depth_count_) : std::numeric_limits<float>::infinity();
  }
}

}  // namespace becalm::tracer
