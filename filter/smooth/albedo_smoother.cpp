#include "filter/smooth/albedo_smoother.h"

#include <algorithm>
#include <array>
#include <cstddef>
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

Image AlbedoSmoother::smooth(const NewFrame& frame, FrameReport& report) {
  Frame still(frame.frame.number(), frame.frame.width(), frame.frame.height());
  Image& beauty = still.add(Aov::beauty);
  pack_albedo(frame.frame.image(Aov::albedo), bounds(task_.full), beauty.data());
  for (const Aov aov : kFeatures) {
    if (contains(task_.used, aov)) still.image(aov) = frame.frame.image(aov);
  }
  const Estimate smoothed =
      smoother_.smooth({.frame = still,
                        .finite = std::vector<std::uint8_t>(beauty.pixel_count(), std::uint8_t{1}),
                        .exposure = 1.0f,
                        .usual_depth = frame.usual_depth},
                       report);
  Image albedo(beauty.width(), beauty.height(), 3);
  const auto width = static_cast<std::size_t>(albedo.width());
  for_rows(albedo.height(), [&](int begin, int end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      std::copy_n(smoothed.color.data().begin() + 4 * i, 3, albedo.data().begin() + 3 * i);
    }
  });
  return albedo;
}

}  // namespace becalm::filter
