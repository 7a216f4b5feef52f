#pragma once

#include <string>
#include <vector>

#include "filter/settings.h"
#include "frame/aov.h"

namespace becalm::filter {

/// The low-noise AOVs that guide the matching: those that frames have, if `settings.guides`.
struct Guides {
  bool albedo = false;
  bool normal = false;
  std::vector<float> weights;  ///< one per plane, in the order of pack_guide

  int planes() const { return static_cast<int>(weights.size()); }
};

Guides guides_of(const Settings& settings, const AovSet& available);

/// A sentence for the user that names what frames with these AOVs are matched by.
std::string matched_text(const Settings& settings, const AovSet& available);

}  // namespace becalm::filter
