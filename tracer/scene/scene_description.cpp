#include "tracer/scene/scene_description.h"

#include <algorithm>

namespace becalm::tracer {

bool CameraSettings::has_lens() const {
  return std::ranges::any_of(aperture_radius.keys(), [](const auto& key) { return key.value[0] > 0.0; });
}

}  // namespace becalm::tracer
