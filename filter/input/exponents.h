#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace becalm::filter {

/// How many values of an image have which binary exponent. Values that are not positive do not count.
class Exponents {
 public:
  void add(float value) {
    if (!(value > 0.0f && std::isfinite(value))) return;
    ++counts_[static_cast<std::size_t>(std::ilogb(value) - kLeast)];
    ++count_;
  }
  Exponents& operator+=(const Exponents& other) {
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
    count_ += other.count_;
    return *this;
  }

  std::uint64_t count() const { return count_; }
  std::uint64_t count_from(int exponent) const { return count_between(exponent, kMost + 1); }
  /// Of those from `first` on, `end` not included.
  std::uint64_t count_between(int first, int end) const {
    std::uint64_t count = 0;
    for (int exponent = first; exponent < end; ++exponent)
      count += counts_[static_cast<std::size_t>(exponent - kLeast)];
    return count;
  }
  /// There must be a value.
  int largest() const {
    const auto last = std::find_if(counts_.rbegin(), counts_.rend(), [](auto count) { return count > 0; });
    return static_cast<int>(counts_.rend() - last) - 1 + kLeast;
  }
  /// The largest that more than a thousandth of the values have or exceed: fireflies are fewer. There must be
  /// a value.
  int largest_usual() const {
    std::uint64_t above = 0;
    for (std::size_t i = counts_.size(); i-- > 0;) {
      above += counts_[i];
      if (above > count_ / 1000) return static_cast<int>(i) + kLeast;
    }
    return kLeast;
  }

 private:
  static constexpr int kLeast = -149, kMost = 127;  ///< of a float
  std::array<std::uint32_t, kMost - kLeast + 1> counts_{};
  std::uint64_t count_ = 0;
};

}  // namespace becalm::filter
