#include "filter/smooth/albedo_smoother.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "filter/for_rows.h"
#include "filter/input/host_images.h"

namespace becalm::filter {
namespace {

constexpr std::array kFeatures = {Aov::normal, Aov::depth};

FilterTask task_of_albedo(const FilterTask& task) {
  FilterTask result{
      .settings = task.settings, .full = task.full, .used = {}, .diagnostics = {}, .guides = {}};
  for (const Aov aov : kFeatures) result.used.set(static_cast<std::size_t>(aov), contains(task.used, aov));
  result.of_albedo = true;
  return result;
}

}  // namespace

AlbedoSmoother::AlbedoSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task_of_albedo(task)), smoother_(device, task_, memory_limit) {}

Image AlbedoSmoother::smooth(const NewFrame& frame, Image albedo, FrameReport& report) {
  Frame still(frame.frame.number(), frame.frame.width(), frame.frame.height());
  Image& beauty = still.image(Aov::beauty) = std::move(albedo);
  for (const Aov aov : kFeatures) {
    if (contains(task_.used, aov)) still.image(aov) = frame.frame.image(aov);
  }
  Estimate smoothed =
      smoother_.smooth({.frame = still,
                        .finite = std::vector<std::uint8_t>(beauty.pixel_count(), std::uint8_t{1}),
                        .exposure = 1.0f,
                        .usual_depth = frame.usual_depth},
                       report);
  return std::move(smoothed.color);
}

Image AlbedoSmoother::smooth(const NewFrame& frame, FrameReport& report) {
  Image packed(task_.full.width, task_.full.height, 4);
  pack_albedo(frame.frame.image(Aov::albedo), bounds(task_.full), packed.data());
  const Image smoothed = smooth(frame, std::move(packed), report);
  Image albedo(smoothed.width(), smoothed.height(), 3);
  for_each_pixel(albedo.width(), albedo.height(), [&](int, int, std::size_t i) {
    std::copy_n(smoothed.data().begin() + 4 * i, 3, albedo.data().begin() + 3 * i);
  });
  return albedo;
}

void AlbedoSmoother::smooth_alpha(const NewFrame& frame, Image& merged, FrameReport& report) {
  const std::span<float> color = merged.data();
  Image alphas(merged.width(), merged.height(), 4);
  for_each_pixel(merged.width(), merged.height(), [&](int, int, std::size_t i) {
    std::fill_n(alphas.data().begin() + 4 * i, 3, std::clamp(color[4 * i + 3], 0.0f, 1.0f));
  });
  const Image smoothed = smooth(frame, std::move(alphas), report);
  for_each_pixel(merged.width(), merged.height(), [&](int, int, std::size_t i) {
    const std::span<const float> rgb = smoothed.data().subspan(4 * i, 3);
    color[4 * i + 3] = std::clamp((rgb[0] + rgb[1] + rgb[2]) / 3.0f, 0.0f, 1.0f);
  });
}

}  // namespace becalm::filter
