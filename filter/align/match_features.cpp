#include "filter/align/match_features.h"

#include <fmt/format.h>

#include <tuple>
#include <utility>

#include "shaders/shared/align_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

/// The firefly test reads the pixels next to each.
constexpr int kFireflyReach = 1;

/// Writes the compressed luminance, smoothed by `prefilter` guided steps, to the last plane of `features`.
void add_radiance_feature(Chain& chain, const Settings& settings, Extent full, const std::string& name,
                          const FeatureSources& sources, ImageId features) {
  const Extent extent = level_extent(settings, full, 0);
  const auto target_of = [&](int step) {
    return step == settings.prefilter
               ? std::pair(features, sources.guide_planes)
               : std::pair(chain.image(fmt::format("radiance.{}.step{}", name, step), Format::f32, extent),
                           0);
  };
  const auto weight_of = [&](int step) { return step == settings.prefilter ? kFeatureRange : 0.0f; };
  auto [radiance, plane] = target_of(0);
  chain.pass("align/radiance_feature")
      .read("color", sources.color, gpu::block(settings.match_downsample, kFireflyReach))
      .read("exposure", sources.exposure)
      .write("features", radiance)
      .constants(params::RadianceFeatureParams{
          .downsample = settings.match_downsample, .plane = plane, .weight = weight_of(0)})
      .dispatch(extent);
  for (int step = 1; step <= settings.prefilter; ++step) {
    const ImageId unfiltered = radiance;
    const int tap_distance = 1 << (step - 1);  // there are two taps on either side
    std::tie(radiance, plane) = target_of(step);
    chain.pass("align/prefilter")
        .read("radiance", unfiltered, gpu::reach(2 * tap_distance))
        .read("guides", sources.guide_features, gpu::reach(2 * tap_distance))
        .write("filtered", radiance)
        .specialize("guide_planes", sources.guide_planes)
        .constants(params::PrefilterParams{.step = tap_distance, .plane = plane, .weight = weight_of(step)})
        .dispatch(extent);
  }
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
        .constants(params::GuideFeatureParams{.plane_in = static_cast<int>(plane),
                                              .plane = static_cast<int>(plane),
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
        .constants(params::GuideFeatureParams{.plane_in = 0, .plane = 0, .weight = 1.0f})
        .dispatch({extent.width, extent.height, sources.guide_planes});
  }
  add_radiance_feature(chain, settings, full, name, sources, features);
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
