#include "filter/guides.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "filter/host_images.h"
#include "frame/error.h"

namespace becalm::filter {

Guides guides_of(const Settings& settings, const AovSet& available) {
  Guides guides;
  guides.albedo = contains(available, Aov::albedo) && settings.weight_albedo > 0.0f;
  guides.normal = contains(available, Aov::normal) && settings.weight_normal > 0.0f;
  guides.weights.insert(guides.weights.end(), guide_planes(guides.albedo, false), settings.weight_albedo);
  guides.weights.insert(guides.weights.end(), guide_planes(false, guides.normal), settings.weight_normal);
  if (guides.planes() == 0 && settings.weight_radiance == 0.0f) {
    throw Error(
        ExitStatus::usage,
        "nothing to match: weight_radiance is 0 and the frames have no albedo or normal that is weighted");
  }
  return guides;
}

std::string matched_text(const Settings& settings, const AovSet& available) {
  const Guides guides = guides_of(settings, available);
  std::vector<std::string> parts;
  const auto add = [&](bool used, std::string_view name, float weight) {
    if (used) parts.push_back(fmt::format("{} ({})", name, weight));
  };
  const bool demodulates = settings.demodulate != 0 && guides.albedo;
  add(settings.weight_radiance > 0.0f, demodulates ? "radiance over albedo" : "radiance",
      settings.weight_radiance);
  add(guides.albedo, "albedo", settings.weight_albedo);
  add(guides.normal, "normal", settings.weight_normal);
  std::string text = fmt::format("frames are matched by {}", fmt::join(parts, ", "));
  if (contains(available, Aov::motion) && settings.motion != MotionUse::none) {
    text += settings.motion == MotionUse::guide ? "; motion is a candidate" : "; motion is taken as it is";
  }
  return text;
}

}  // namespace becalm::filter
