#pragma once

#include <string>
#include <vector>

#include "filter/settings.h"
#include "frame/aov.h"

namespace becalm::filter {

/// The low-noise AOVs that guide the matching: those that the frames have, if the settings ask for guides.
struct Guides {
  bool albedo = false;
  bool normal = false;
  std::vector<float> weights;  ///< one entry a plane, in the order of pack_guide

  int planes() const { return static_cast<int>(weights.size()); }
};

Guides guides_of(const Settings& settings, const AovSet& available);

/// What frames with these AOVs are matched by, in words.
std::string matched_text(const Settings& settings, const AovSet& available);

}  // namespace becalm::filter
