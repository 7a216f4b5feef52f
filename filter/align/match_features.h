#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filter/align/pyramid.h"
#include "filter/gpu/chain.h"
#include "filter/settings.h"

namespace becalm::filter {

/// Range of features with weight 1. The logarithm of Hanika et al. 2021, eq. 4, bends at differences of about
/// 2, and the center weight of eq. 5 raises the distance of equal pixels, log 2, by up to half: for features
/// in [0,1] it would outweigh any contrast.
constexpr float kFeatureRange = 16.0f;

/// Feature planes at matching resolution, the same for target and source.
struct Features {
  gpu::ImageId image;
  int planes = 0;
};

/// Images that features are made from. The guide holds `guide_planes` planes of low-noise AOVs.
struct FeatureSources {
  gpu::ImageId color;                          ///< f32x4, full resolution: radiance
  gpu::ImageId exposure;                       ///< f32, 1x1: scales the frame's typical luminance to 1
  std::optional<gpu::ImageId> guide_features;  ///< matching resolution, from add_guide_passes
  int guide_planes = 0;
};

/// Writes the guide planes to `guide_features` at matching resolution, each multiplied by its weight;
/// `weights` has one entry per plane.
void add_guide_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full, gpu::ImageId guide,
                      const std::vector<float>& weights, gpu::ImageId guide_features);

/// Makes features: the guide's planes, then the compressed luminance. `name` is part of the images' names.
Features add_feature_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                            const std::string& name, const FeatureSources& sources);

/// Features of each level of the range, downsampled from `finest`. `full` is the size at full resolution.
std::vector<Features> add_pyramid(gpu::Chain& chain, const Settings& settings, const LevelRange& levels,
                                  gpu::Extent full, const Features& finest, const std::string& name);

}  // namespace becalm::filter
