#include "filter/smooth/merged_smoother.h"

#include <algorithm>
#include <span>
#include <utility>

#include "filter/for_rows.h"

namespace becalm::filter {
namespace {

/// Calls `use(index)` for each pixel, on all threads.
template <class Use>
void for_pixels(const Image& image, const Use& use) {
  const auto width = static_cast<std::size_t>(image.width());
  for_rows(image.height(), [&](int begin, int end) {
    for (std::size_t i = begin * width; i < end * width; ++i) use(i);
  });
}

FilterTask task_of_merged(FilterTask task) {
  task.used.set(static_cast<std::size_t>(Aov::variance));
  for (const Aov half : {Aov::half_a, Aov::half_b}) task.used.reset(static_cast<std::size_t>(half));
  task.merged = true;
  return task;
}

}  // namespace

Accumulated accumulated(const Estimate& merged) {
  const auto layers = std::span(merged.carried).last<FilterTask::kNoisyLayers>();
  const Image& radiance = layers[FilterTask::kNoisyRadiance];
  const Image& albedo_depth = layers[FilterTask::kNoisyAlbedoDepth];
  const Image& normal = layers[FilterTask::kNoisyNormal];
  const int width = radiance.width();
  const int height = radiance.height();
  Accumulated result{.color = Image(width, height, 3, Unfilled()),
                     .variance = Image(width, height, 1, Unfilled()),
                     .albedo = Image(width, height, 3, Unfilled()),
                     .normal = Image(width, height, 3, Unfilled()),
                     .depth = Image(width, height, 1, Unfilled())};
  const auto copy = [](const Image& layer, std::size_t pixel, Image& target) {
    std::copy_n(layer.data().begin() + 4 * pixel, 3, target.data().begin() + 3 * pixel);
  };
  for_pixels(radiance, [&](std::size_t i) {
    copy(radiance, i, result.color);
    copy(albedo_depth, i, result.albedo);
    copy(normal, i, result.normal);
    // A sharp resampling filter may leave the range of the history's pixels.
    for (float& value : result.albedo.data().subspan(3 * i, 3)) value = std::clamp(value, 0.0f, 1.0f);
    result.depth.data()[i] = std::clamp(albedo_depth.data()[4 * i + 3], 0.0f, 2.0f);
    const float frames = std::max(merged.stats.data()[2 * i + 1], 1.0f);
    result.variance.data()[i] = std::max(radiance.data()[4 * i + 3], 0.0f) / frames;
  });
  return result;
}

MergedSmoother::MergedSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task_of_merged(task)), smoother_(device, task_, memory_limit) {}

Estimate MergedSmoother::smooth(const NewFrame& frame, Estimate merged, FrameReport& report) {
  Accumulated noisy = accumulated(merged);
  Frame still(frame.frame.number(), frame.frame.width(), frame.frame.height());
  Image& beauty = still.image(Aov::beauty) = std::move(merged.color);
  Image& variance = still.add(Aov::variance);
  for_pixels(beauty, [&](std::size_t i) {
    std::copy_n(noisy.color.data().begin() + 3 * i, 3, beauty.data().begin() + 4 * i);
    std::fill_n(variance.data().begin() + 3 * i, 3, noisy.variance.data()[i]);
    float& depth = noisy.depth.data()[i];
    depth = frame.usual_depth * depth / (2.0f - depth);  // infinite where nothing was hit
  });
  if (contains(task_.used, Aov::albedo)) still.image(Aov::albedo) = std::move(noisy.albedo);
  if (contains(task_.used, Aov::normal)) still.image(Aov::normal) = std::move(noisy.normal);
  if (contains(task_.used, Aov::depth)) still.image(Aov::depth) = std::move(noisy.depth);
  merged.carried.resize(task_.additive);
  Estimate smoothed = smoother_.smooth({.frame = still,
                                        .own = &frame,
                                        .finite = frame.finite,
                                        .exposure = frame.exposure,
                                        .usual_depth = frame.usual_depth,
                                        .noise_ratio = frame.noise_ratio,
                                        .additive = std::move(merged.carried)},
                                       report);
  for_pixels(beauty,
             [&](std::size_t i) { smoothed.stats.data()[2 * i + 1] = merged.stats.data()[2 * i + 1]; });
  return smoothed;
}

}  // namespace becalm::filter
