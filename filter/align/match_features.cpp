#include "filter/align/match_features.h"

#include <fmt/format.h>

#include "shaders/shared/align_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

/// The firefly test reads the pixels next to each.
constexpr int kFireflyReach = 1;

/// Writes the compressed luminance to the last plane of `features`.
void add_radiance_feature(Chain& chain, const Settings& settings, Extent full, const FeatureSources& sources,
                          ImageId features) {
  chain.pass("align/radiance_feature")
      .read("color", sources.color, gpu::block(settings.match_downsample, kFireflyReach))
      .read("exposure", sources.exposure)
      .write("features", features)
      .specialize("downsample", settings.match_downsample)
      .constants(params::RadianceFeatureParams{.plane = sources.guide_planes, .weight = kFeatureRange})
      .dispatch(level_extent(settings, full, 0));
}

}  // namespace

void add_guide_passes(Chain& chain, const Settings& settings, Extent full, ImageId guide,
                      const std::vector<float>& weights, ImageId guide_features) {
  const Extent extent = level_extent(settings, full, 0);
  for (std::size_t plane = 0; plane < weights.size(); ++plane) {
    chain.pass("align/guide_feature")
        .read("guide", guide, gpu::block(settings.match_downsample))
        .write("features", guide_features)
        .specialize("downsample", settings.match_downsample)
        .constants(params::GuideFeatureParams{.plane = static_cast<int>(plane),
                                              .weight = kFeatureRange * weights[plane]})
        .dispatch(extent);
  }
}

Features add_feature_passes(Chain& chain, const Settings& settings, Extent full, const std::string& name,
                            const FeatureSources& sources) {
  const Extent extent = level_extent(settings, full, 0);
  const int planes = sources.guide_planes + 1;
  const ImageId features =
      chain.image(fmt::format("features.{}.L0", name), Format::f32, {extent.width, extent.height, planes});
  if (sources.guide_planes > 0) {
    chain.pass("align/guide_feature")
        .read("guide", *sources.guide_features)
        .write("features", features)
        .specialize("downsample", 1)
        .constants(params::GuideFeatureParams{.plane = 0, .weight = 1.0f})
        .dispatch({extent.width, extent.height, sources.guide_planes});
  }
  add_radiance_feature(chain, settings, full, sources, features);
  return {features, planes};
}

std::vector<Features> add_pyramid(Chain& chain, const Settings& settings, const LevelRange& levels,
                                  Extent full, const Features& finest, const std::string& name) {
  std::vector<Features> pyramid{finest};
  for (std::size_t l = levels.finest + 1; l < levels.end; ++l) {
    const Extent extent = level_extent(settings, full, l).with_planes(finest.planes);
    const ImageId coarse = chain.image(fmt::format("features.{}.L{}", name, l), Format::f32, extent);
    chain.pass("align/downsample")
        .read("fine", pyramid.back().image, gpu::block(settings.pyramid.factor))
        .write("coarse", coarse)
        .specialize("factor", settings.pyramid.factor)
        .dispatch(extent);
    pyramid.push_back({coarse, finest.planes});
  }
  return pyramid;
}

}  // namespace becalm::filter
