#pragma once

#include <string>

#include "frame/aov.h"

namespace becalm::app {

/// What --aovs names: AOVs of the tracer, and whether the radiance of each light group.
struct AskedAovs {
  AovSet aovs;
  bool light_groups = false;
  AovSet named = {};  ///< those of them that were named, not meant by `all`
};
/// Throws Error(usage) naming what is no AOV, and what was expected.
AskedAovs parse_aovs(const std::string& text);

/// The inverse of parse_aovs.
std::string format_aovs(const AskedAovs& asked);

}  // namespace becalm::app
