#include "filter/smooth.h"

#include <fmt/format.h>

#include "filter/ceil_div.h"
#include "shaders/shared/smooth_params.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

constexpr int kShiftsPerPlane = 4;  // as in shaders/lib/patch_weights.glsl
constexpr int kRows = 16;           // as in shaders/smooth/weights.comp

int weight_planes(const Settings& settings) {
  const int side = 2 * settings.smooth_radius + 1;
  return ceil_div(side * side, kShiftsPerPlane);
}

}  // namespace

Smoothed add_smooth_passes(Chain& chain, const Settings& settings, Extent full, const NoisyInputs& frame,
                           const std::vector<ImageId>& additive) {
  const FeatureImages& features = frame.features.value();
  const params::SmoothParams params{.width = full.width,
                                    .height = full.height,
                                    .strength = settings.smooth_strength,
                                    .surfaces = settings.smooth_surfaces};
  const ImageId irradiance = chain.image("irradiance", Format::f32x4, full);
  const ImageId guide = chain.image("smooth.guide", Format::f32x2, full);
  chain.pass("smooth/demodulate")
      .read("color", frame.color)
      .read("variance", frame.variance)
      .read("albedo_depth", features.albedo_depth)
      .read("exposure", frame.exposure)
      .write("irradiance", irradiance)
      .write("guide", guide)
      .constants(params)
      .dispatch(full);
  const int planes = weight_planes(settings);
  const ImageId weights = chain.image("smooth.weights", Format::u32, full.with_planes(planes));
  chain.pass("smooth/weights")
      .read("guide", guide)
      .write("weights", weights)
      .specialize("radius", settings.smooth_radius)
      .specialize("patch_radius", settings.smooth_patch_radius)
      .constants(params)
      .dispatch({full.width, ceil_div(full.height, kRows), planes});
  Smoothed smoothed{chain.image("smoothed.color", Format::f32x4, full),
                    chain.image("smoothed.stats", Format::f32x2, full),
                    {}};
  const Extent kernel_extent = additive.empty() ? Extent{1, 1} : full;
  const ImageId kernel = chain.image("smooth.kernel", Format::f32x4, kernel_extent.with_planes(3));
  chain.pass("smooth/regress")
      .read("color", frame.color)
      .read("variance", frame.variance)
      .read("irradiance", irradiance)
      .read("guide", guide)
      .read("albedo_depth", features.albedo_depth)
      .read("normal", features.normal)
      .read("exposure", frame.exposure)
      .read("weights", weights)
      .write("smoothed", smoothed.color)
      .write("stats", smoothed.stats)
      .write("kernel", kernel)
      .specialize("radius", settings.smooth_radius)
      .specialize("writes_kernel", additive.empty() ? 0 : 1)
      .constants(params)
      .dispatch(full);
  for (std::size_t i = 0; i < additive.size(); ++i) {
    smoothed.additive.push_back(chain.image(fmt::format("smoothed.additive.{}", i), Format::f32x4, full));
    chain.pass("additive/smooth")
        .read("color", additive[i])
        .read("variance", frame.variance)
        .read("albedo_depth", features.albedo_depth)
        .read("normal", features.normal)
        .read("weights", weights)
        .read("kernel", kernel)
        .write("smoothed", smoothed.additive.back())
        .specialize("radius", settings.smooth_radius)
        .constants(params)
        .dispatch(full);
  }
  return smoothed;
}

int smooth_margin_px(const Settings& settings) {
  constexpr int variance_mean = 1;
  return settings.smooth_radius + settings.smooth_patch_radius + variance_mean;
}

}  // namespace becalm::filter
