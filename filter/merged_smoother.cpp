#include "filter/merged_smoother.h"

#include <algorithm>
#include <utility>

namespace becalm::filter {
namespace {

FilterTask task_of_merged(FilterTask task) {
  task.used.set(static_cast<std::size_t>(Aov::variance));
  for (const Aov half : {Aov::half_a, Aov::half_b}) task.used.reset(static_cast<std::size_t>(half));
  return task;
}

}  // namespace

Accumulated accumulated(const Estimate& merged) {
  const Image& carried = merged.additive.back();
  Accumulated result{Image(carried.width(), carried.height(), 3), Image(carried.width(), carried.height(), 1)};
  for (std::size_t i = 0; i < carried.pixel_count(); ++i) {
    const auto pixel = carried.data().subspan(4 * i, 4);
    std::ranges::copy(pixel.first(3), result.color.data().subspan(3 * i, 3).begin());
    const float frames = std::max(merged.stats.data()[2 * i + 1], 1.0f);
    result.variance.data()[i] = std::max(pixel[3], 0.0f) / frames;
  }
  return result;
}

MergedSmoother::MergedSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task_of_merged(task)), smoother_(device, task_, memory_limit) {}

Estimate MergedSmoother::smooth(const NewFrame& frame, Estimate merged, FrameReport& report) {
  const Accumulated noisy = accumulated(merged);
  Frame still(frame.frame.number(), frame.frame.width(), frame.frame.height());
  Image& beauty = still.image(Aov::beauty) = std::move(merged.color);
  Image& variance = still.add(Aov::variance);
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    std::ranges::copy(noisy.color.data().subspan(3 * i, 3), beauty.data().subspan(4 * i, 3).begin());
    std::ranges::fill_n(variance.data().begin() + 3 * i, 3, noisy.variance.data()[i]);
  }
  for (const Aov aov : {Aov::albedo, Aov::normal, Aov::depth}) {
    if (contains(task_.used, aov)) still.image(aov) = frame.frame.image(aov);
  }
  merged.additive.pop_back();
  Estimate smoothed = smoother_.smooth({.frame = still,
                                        .finite = frame.finite,
                                        .exposure = frame.exposure,
                                        .usual_depth = frame.usual_depth,
                                        .additive = std::move(merged.additive)},
                                       report);
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    smoothed.stats.data()[2 * i + 1] = merged.stats.data()[2 * i + 1];
  }
  return smoothed;
}

}  // namespace becalm::filter
