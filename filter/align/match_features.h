#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filter/align/pyramid.h"
#include "filter/gpu/chain.h"
#include "filter/settings.h"

namespace becalm::filter {

/// Range of features that are weighted by 1. The logarithm of eq. 4 of Hanika et al. 2021 bends at
/// differences of about 2, and the center weight of eq. 5 raises the distance of equal pixels, log 2, by up
/// to half of it: on features in [0,1] it would outweigh any contrast.
constexpr float kFeatureRange = 16.0f;

/// What is matched: planes of features at matching resolution, and for target and source alike.
struct Features {
  gpu::ImageId image;
  int planes = 0;
};

/// Full-resolution images that features are made from. The guide holds `guide_planes` planes of low-noise
/// AOVs.
struct FeatureSources {
  gpu::ImageId color;                          ///< f32x4, radiance
  gpu::ImageId exposure;                       ///< f32, 1x1: brings the frame's typical luminance to 1
  std::optional<gpu::ImageId> guide_features;  ///< as add_guide_passes made them
  int guide_planes = 0;
};

/// Guide planes at matching resolution, each multiplied by its weight; `weights` has one entry a plane.
void add_guide_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full, gpu::ImageId guide,
                      const std::vector<float>& weights, gpu::ImageId guide_features);

/// Features called `name`: the guide's planes, then the compressed luminance.
Features add_feature_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                            const std::string& name, const FeatureSources& sources);

/// Features of each level of the range, of images that are `full` at full resolution; `finest` are given.
std::vector<Features> add_pyramid(gpu::Chain& chain, const Settings& settings, const LevelRange& levels,
                                  gpu::Extent full, const Features& finest, const std::string& name);

/// How far from a pixel its features depend on the images that they are made from.
int feature_margin_px(const Settings& settings);

}  // namespace becalm::filter
