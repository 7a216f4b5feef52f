#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

namespace becalm::bench {

struct Duration {
  double wall_s = 0.0;
  double processor_s = 0.0;  ///< of all threads together; other programs change it less than wall time
};

template <class F>
Duration time_of(const F& work) {
  timespec before{}, after{};
  const auto start = std::chrono::steady_clock::now();
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &before);
  work();
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &after);
  const auto seconds = [](const timespec& t) {
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          seconds(after) - seconds(before)};
}

/// The middle one of an odd number of values.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Durations of repeated runs.
class Runs {
 public:
  void add(const Duration& duration) {
    wall_.push_back(duration.wall_s);
    processor_.push_back(duration.processor_s);
  }
  /// The medians of wall and of processor time.
  Duration middle() const { return {median(wall_), median(processor_)}; }

  /// The median ratio of processor times of runs with the same index, which alternated and so ran under the
  /// same conditions.
  double ratio_to(const Runs& other) const {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < processor_.size(); ++i) ratios.push_back(processor_[i] / other.processor_[i]);
    return median(ratios);
  }

 private:
  std::vector<double> wall_, processor_;
};

}  // namespace becalm::bench
