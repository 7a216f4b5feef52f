#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace becalm::tracer {

enum class Interpolation { linear, smooth };

/// N numbers as a function of time, through keys at strictly increasing frames. Before the first and after
/// the last key their values hold.
///
/// `linear` is piecewise linear. `smooth` is a cubic Hermite spline for each number, with the slopes of
/// Steffen ("A simple method for monotonic interpolation in one dimension", 1990, eq. 11): C1, monotone
/// between keys, so it never overshoots. Differs from the paper: the first and last slope are 0, so that
/// motion is C1 through the holds as well and two keys give an ease in and out.
template <std::size_t N>
class Curve {
 public:
  using Value = std::array<double, N>;
  struct Key {
    double frame;
    Value value;
  };

  Curve(const Value& constant) : keys_{{0.0, constant}} {}
  Curve(std::vector<Key> keys, Interpolation interpolation)
      : keys_(std::move(keys)), interpolation_(interpolation) {
    assert(!keys_.empty());
    if (interpolation_ == Interpolation::smooth) compute_slopes();
  }

  const std::vector<Key>& keys() const { return keys_; }
  Interpolation interpolation() const { return interpolation_; }

  /// Whether the value ever changes.
  bool animated() const {
    return std::any_of(keys_.begin(), keys_.end(),
                       [this](const Key& key) { return key.value != keys_.front().value; });
  }

  Value at(double frame) const {
    if (frame <= keys_.front().frame) return keys_.front().value;
    if (frame >= keys_.back().frame) return keys_.back().value;
    const auto above = std::upper_bound(keys_.begin(), keys_.end(), frame,
                                        [](double f, const Key& key) { return f < key.frame; });
    const std::size_t i = static_cast<std::size_t>(above - keys_.begin()) - 1;
    const Key& a = keys_[i];
    const Key& b = keys_[i + 1];
    const double span = b.frame - a.frame;
    const double t = (frame - a.frame) / span;
    Value value;
    for (std::size_t c = 0; c < N; ++c) {
      if (interpolation_ == Interpolation::linear) {
        value[c] = a.value[c] + t * (b.value[c] - a.value[c]);
      } else {
        const double rise = b.value[c] - a.value[c];
        const double slope_a = slopes_[i][c] * span, slope_b = slopes_[i + 1][c] * span;
        value[c] = a.value[c] + t * (slope_a + t * ((3.0 * rise - 2.0 * slope_a - slope_b) +
                                                    t * (slope_a + slope_b - 2.0 * rise)));
      }
    }
    return value;
  }

 private:
  void compute_slopes() {
    slopes_.assign(keys_.size(), Value{});
    for (std::size_t i = 1; i + 1 < keys_.size(); ++i) {
      const double before = keys_[i].frame - keys_[i - 1].frame;
      const double after = keys_[i + 1].frame - keys_[i].frame;
      for (std::size_t c = 0; c < N; ++c) {
        const double secant_before = (keys_[i].value[c] - keys_[i - 1].value[c]) / before;
        const double secant_after = (keys_[i + 1].value[c] - keys_[i].value[c]) / after;
        if (secant_before * secant_after <= 0.0) continue;
        const double parabola = (secant_before * after + secant_after * before) / (before + after);
        const double limit =
            std::min({std::abs(secant_before), std::abs(secant_after), 0.5 * std::abs(parabola)});
        slopes_[i][c] = std::copysign(2.0 * limit, secant_before);
      }
    }
  }

  std::vector<Key> keys_;
  std::vector<Value> slopes_;  ///< change per frame at each key; only for smooth
  Interpolation interpolation_ = Interpolation::linear;
};

}  // namespace becalm::tracer
