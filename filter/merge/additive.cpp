#include "filter/merge/additive.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "filter/input/host_images.h"
#include "frame/error.h"

namespace becalm::filter {
namespace {

constexpr std::array kAdditiveAovs{Aov::direct, Aov::indirect};

/// The additive AOVs of a frame, const or not.
template <class Result, class AnyFrame>
std::vector<Result*> images_of(AnyFrame& frame, const AovSet& used) {
  std::vector<Result*> images;
  for (const Aov aov : kAdditiveAovs) {
    if (contains(used, aov)) images.push_back(&frame.image(aov));
  }
  std::map<std::string_view, Result*> groups;
  for (auto& group : frame.light_groups()) groups.emplace(group.name, &group.radiance);
  for (const auto& [name, radiance] : groups) images.push_back(radiance);
  return images;
}

}  // namespace

AovSet additive_aovs() {
  AovSet set;
  for (const Aov aov : kAdditiveAovs) set.set(static_cast<std::size_t>(aov));
  return set;
}

std::vector<Image*> additive_images(Frame& frame, const AovSet& used) {
  return images_of<Image>(frame, used);
}

std::vector<const Image*> additive_images(const Frame& frame, const AovSet& used) {
  return images_of<const Image>(frame, used);
}

std::vector<Image> pack_additive(const Frame& frame, const FilterTask& task,
                                 std::span<const std::uint8_t> finite, FrameReport& report) {
  if (task.additive == 0) return {};
  const std::vector<const Image*> images = additive_images(frame, task.used);
  if (images.size() != task.additive) {
    const std::size_t others = images.size() - frame.light_groups().size();
    throw Error(ExitStatus::bad_input,
                fmt::format("frame {}: has {} light groups: expected {} as the frames before it",
                            frame.number(), frame.light_groups().size(), task.additive - others));
  }
  std::vector<Image> packed;
  for (const Image* image : images) {
    Image radiance(frame.width(), frame.height(), 4);
    for (std::size_t i = 0; i < finite.size(); ++i) {
      if (!finite[i]) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = image->data()[3 * i + c];
        if (std::isfinite(value)) {
          radiance.data()[4 * i + c] = value;
        } else {
          ++report.replaced_additive;
        }
      }
    }
    Image& whole = packed.emplace_back(frame.width(), frame.height(), 4);
    pack_color(radiance, finite, bounds(task.full), whole.data());
  }
  return packed;
}

void unpack_additive(const NewFrame& frame, const FilterTask& task, const std::vector<Image>& denoised,
                     std::span<const std::uint8_t> as_they_came, Frame& result) {
  if (task.additive == 0) return;
  for (const Aov aov : kAdditiveAovs) {
    if (contains(task.used, aov)) result.add(aov);
  }
  for (const LightGroup& group : frame.frame.light_groups()) {
    result.light_groups().push_back({group.name, Image(result.width(), result.height(), 3)});
  }
  const std::vector<const Image*> sources = additive_images(frame.frame, task.used);
  const std::vector<Image*> targets = additive_images(result, task.used);
  for (std::size_t n = 0; n < targets.size(); ++n) {
    for (std::size_t i = 0; i < as_they_came.size(); ++i) {
      const auto pixel = as_they_came[i] ? sources[n]->data().subspan(3 * i, 3)
                                         : std::span<const float>(denoised[n].data()).subspan(4 * i, 3);
      std::ranges::copy(pixel, targets[n]->data().subspan(3 * i, 3).begin());
    }
  }
}

}  // namespace becalm::filter
