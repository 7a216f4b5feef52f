#include "filter/align/guides.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "filter/input/host_images.h"

namespace becalm::filter {
namespace {

/// Weight of one plane; the radiance's is 1. Clean features show motion better than noisy radiance does, and
/// normals vary less than albedo.
constexpr float kWeightOfAlbedo = 2.0f;
constexpr float kWeightOfNormal = 0.5f;

}  // namespace

Guides guides_of(const Settings& settings, const AovSet& available) {
  Guides guides;
  if (!settings.guides) return guides;
  guides.albedo = contains(available, Aov::albedo);
  guides.normal = contains(available, Aov::normal);
  guides.weights.insert(guides.weights.end(), guide_planes(guides.albedo, false), kWeightOfAlbedo);
  guides.weights.insert(guides.weights.end(), guide_planes(false, guides.normal), kWeightOfNormal);
  return guides;
}

std::string matched_text(const Settings& settings, const AovSet& available) {
  const Guides guides = guides_of(settings, available);
  std::vector<std::string_view> parts{"radiance"};
  if (guides.albedo) parts.push_back("albedo");
  if (guides.normal) parts.push_back("normal");
  std::string text = fmt::format("frames are matched by {}", fmt::join(parts, ", "));
  if (contains(available, Aov::motion) && settings.motion != MotionUse::none) {
    text += settings.motion == MotionUse::guide ? "; motion is a candidate" : "; motion is taken as it is";
  }
  return text;
}

}  // namespace becalm::filter
