#include "filter/guides.h"

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

}  // namespace becalm::filter
