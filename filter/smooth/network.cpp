#include "filter/smooth/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "filter/ceil_div.h"
#include "filter/smooth/convolution.h"
#include "filter/smooth/detail_share.h"
#include "filter/smooth/host_features.h"
#include "filter/smooth/own_share.h"
#include "filter/smooth/restore.h"

namespace becalm::filter {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

namespace {

/// Radius of the windows over radiance, albedo and grey value; kWindowTaps are its pixels.
constexpr int kWindowRadius = 2;

/// Weights of 1x1 layers with concatenated outputs, as shaders/lib/head.glsl reads them.
std::vector<float> pack_head(const std::vector<const Layer*>& layers) {
  std::vector<float> values;
  std::vector<float> biases;
  for (const Layer* layer : layers) {
    values.insert(values.end(), layer->weight.begin(), layer->weight.end());
    biases.insert(biases.end(), layer->bias.begin(), layer->bias.end());
  }
  biases.resize(static_cast<std::size_t>(ceil_div(static_cast<int>(biases.size()), kPlane)) * kPlane);
  values.insert(values.end(), biases.begin(), biases.end());
  return values;
}

/// Rows of pixels that one invocation of smooth/mix and smooth/finish computes, whose windows share reads.
/// Hardware needs many invocations; for small images the longer kernel takes more time to compile than it
/// saves.
int window_strip(const gpu::DeviceInfo& device, Extent image) {
  constexpr std::size_t small_px = 512 * 512;
  return device.is_processor && image.elements() > small_px ? 2 : 1;
}

int padded_px(int size) {
  return ceil_div(size, kNetworkGridPx) * kNetworkGridPx;
}

}  // namespace

Extent NetworkPasses::extent(std::size_t scale) const {
  return {padded_.width >> scale, padded_.height >> scale};
}

ImageId NetworkPasses::weights_image(Chain& chain, const std::string& name, const NetworkWeights& weights,
                                     Pack pack) {
  const int vectors = static_cast<int>(pack(weights).size()) / kPlane;
  const ImageId image = chain.table("weights." + name, Format::f32x4, {vectors, 1});
  weights_.push_back({image, std::move(pack)});
  return image;
}

NetworkWeights NetworkPasses::used(const NetworkWeights& network) const {
  return merged_ ? network : of_single_frame(network);
}

void NetworkPasses::upload_weights(Chain& chain, const NetworkWeights& trained) const {
  const NetworkWeights network = used(trained);
  for (const auto& [image, pack] : weights_) {
    std::ranges::copy(pack(network), chain.upload<float>(image).begin());
  }
  host_weights_->replace(network);
}

NetworkPasses::NetworkPasses(Chain& chain, const Weights& trained, Extent full, const NoisyInputs& frame,
                             bool variance_known, const std::vector<Layered>& additive, Convolver convolver,
                             std::optional<int> strip)
    : full_(full),
      padded_{padded_px(full.width), padded_px(full.height)},
      strip_(strip),
      merged_(frame.own_color != frame.color),
      framed_(convolver == Convolver::host ? 1 : 0),
      host_weights_(std::make_shared<HostWeights>(used(trained.network))) {
  const NetworkWeights& weights = host_weights_->network();
  const Demodulated beauty =
      add_demodulate(chain, frame, "beauty", {frame.color, frame.own_color}, /*wants_grey=*/true);
  const ImageId inputs = add_inputs(chain, frame, beauty, variance_known);
  features_ = convolver == Convolver::host
                  ? add_host_features(chain, weights.channels, host_weights_, padded_, inputs)
                  : add_features(chain, weights, inputs);
  for (std::size_t i = 0; i < kScales; ++i) {
    confidence_weights_[i] =
        weights_image(chain, fmt::format("confidence.L{}", i), weights,
                      [i](const NetworkWeights& w) { return pack_head({&w.confidence[i]}); });
    window_weights_[i] = weights_image(chain, fmt::format("window.L{}", i), weights,
                                       [i](const NetworkWeights& w) { return pack_head({&w.window[i]}); });
  }
  finish_weights_ = weights_image(chain, "finish", weights, [](const NetworkWeights& w) {
    return pack_head({&w.albedo, &w.error});
  });

  const ImageId color = chain.image("windows.color", Format::f32x4, full);
  const ImageId stats = chain.image("windows.stats", Format::f32x2, full);
  const Windows windows =
      add_windows(chain, weights, frame, beauty.irradiance, color, stats, !additive.empty());
  if (!trained.own_share) {
    smoothed_ = {.color = color, .stats = stats, .additive = {}};
    return;
  }
  const auto [share, remaining] = add_detail_share(chain, full_, frame, color, stats);
  smoothed_.stats = remaining;
  smoothed_.color = add_restore(chain, full_, "smoothed.color", frame.color, color, share);
  std::optional<ImageId> own_share;
  if (merged_) {
    const OwnShare own = add_own_share(chain, full_, frame, {smoothed_.color, smoothed_.stats, share, {}},
                                       weights_image(chain, "own_share", weights,
                                                     [packed = pack_own_share(*trained.own_share)](
                                                         const NetworkWeights&) { return packed; }));
    smoothed_.color = add_restore(chain, full_, "mixed.color", frame.own_color, smoothed_.color, own.share);
    smoothed_.stats = own.stats;
    own_share = own.share;
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < additive.size(); ++i) names.push_back(fmt::format("additive.{}", i));
  for (std::size_t first = 0; first < additive.size(); first += kLightsAtOnce) {
    const std::size_t count = std::min<std::size_t>(kLightsAtOnce, additive.size() - first);
    const std::vector<ImageId> made =
        add_light_windows(chain, weights, frame, std::span(names).subspan(first, count),
                          std::span(additive).subspan(first, count), windows);
    for (std::size_t l = 0; l < count; ++l) {
      const Layered& light = additive[first + l];
      const std::string& name = names[first + l];
      ImageId result = add_restore(chain, full_, "smoothed." + name, light.merged, made[l], share);
      if (own_share) result = add_restore(chain, full_, "mixed." + name, light.own, result, *own_share);
      smoothed_.additive.push_back(result);
    }
  }
}

NetworkPasses::Demodulated NetworkPasses::add_demodulate(Chain& chain, const NoisyInputs& frame,
                                                         const std::string& name, const Layered& radiance,
                                                         bool wants_grey) const {
  const auto add = [&](const std::string& prefix, ImageId color, ImageId albedo_depth) {
    const ImageId irradiance = chain.image(prefix + ".irradiance", Format::f32x4, padded_);
    std::optional<ImageId> grey;
    if (wants_grey) grey = chain.image(prefix + ".grey", Format::f32, padded_);
    chain.pass("smooth/demodulate")
        .read("color", color)
        .read("variance", frame.variance)
        .read("albedo_depth", albedo_depth)
        .read("exposure", frame.exposure)
        .write("irradiance", irradiance)
        .write("grey", grey)
        .specialize("has_grey", wants_grey ? 1 : 0)
        .dispatch(padded_);
    return std::pair(irradiance, grey.value_or(ImageId{}));
  };
  const auto [irradiance, grey] = add(name, radiance.merged, frame.features->albedo_depth);
  if (radiance.own == radiance.merged) return {{irradiance, irradiance}, {grey, grey}};
  const auto [own_irradiance, own_grey] = add("own." + name, radiance.own, frame.own_features->albedo_depth);
  return {{irradiance, own_irradiance}, {grey, own_grey}};
}

ImageId NetworkPasses::add_inputs(Chain& chain, const NoisyInputs& frame, const Demodulated& demodulated,
                                  bool variance_known) const {
  const int count = merged_ ? kNetworkInputs : kSingleFrameInputs;
  const ImageId inputs = chain.image("network.inputs", Format::f32x4, padded_.with_planes(count / kPlane));
  // Plane by plane: the inputs of 1920x1080 pixels are more than some devices can bind at once.
  chain.pass("smooth/inputs")
      .read("irradiance", demodulated.irradiance.merged)
      .read("grey", demodulated.grey.merged, gpu::reach(kWindowRadius))  // its local deviation
      .read("variance", frame.variance)
      .read("albedo_depth", frame.features->albedo_depth)
      .read("normal", frame.features->normal)
      .read("exposure", frame.exposure)
      .write_plane("radiance_inputs", inputs, 0)
      .write_plane("surface_inputs", inputs, 1)
      .write_plane("noise_inputs", inputs, 2)
      .specialize("variance_known", variance_known ? 1 : 0)
      .dispatch(padded_);
  if (!merged_) return inputs;
  chain.pass("smooth/own_inputs")
      .read("own_grey", demodulated.grey.own)
      .read("own_albedo_depth", frame.own_features->albedo_depth)
      .read("own_normal", frame.own_features->normal)
      .write_plane("surface_inputs", inputs, 3)
      .write_plane("grey_inputs", inputs, 4)
      .dispatch(padded_);
  return inputs;
}

ImageId NetworkPasses::add_convolution(Chain& chain, const std::string& name, const NetworkWeights& weights,
                                       const LayerOf& layer_of, std::size_t scale, ImageId source,
                                       const Coarse& coarse) {
  const auto convolution = [=, upsampled = coarse ? coarse->channels : 0](const NetworkWeights& w) {
    return Convolution(layer_of(w), upsampled);
  };
  const ImageId packed = weights_image(
      chain, name, weights, [convolution](const NetworkWeights& w) { return convolution(w).weights(); });
  return convolution(weights).add_passes(chain, "network." + name, extent(scale), packed, source,
                                         coarse ? coarse->features : ImageId{});
}

NetworkPasses::Scales NetworkPasses::add_features(Chain& chain, const NetworkWeights& weights,
                                                  ImageId inputs) {
  Scales features;
  for (std::size_t i = 0; i < kScales; ++i) {
    ImageId source = inputs;
    if (i > 0) {
      const int planes = weights.channels[i - 1] / kPlane;
      source =
          chain.image(fmt::format("network.pooled.L{}", i), Format::f32x4, extent(i).with_planes(planes));
      chain.pass("smooth/pool")
          .read("fine", features[i - 1], gpu::block(2))
          .write("coarse", source)
          .dispatch(extent(i).with_planes(planes));
    }
    features[i] = add_convolution(chain, fmt::format("encode.L{}", i), weights, encoder(i), i, source, {});
  }
  for (std::size_t i = kScales - 1; i-- > 0;) {
    features[i] = add_convolution(chain, fmt::format("decode.L{}", i), weights, decoder(i), i, features[i],
                                  CoarseFeatures{features[i + 1], weights.channels[i + 1]});
  }
  features[0] = add_convolution(chain, "finish.L0", weights, finisher(), 0, features[0], {});
  return features;
}

int NetworkPasses::strip(const Chain& chain, Extent extent) const {
  return strip_.value_or(window_strip(chain.device(), extent));
}

std::vector<ImageId> NetworkPasses::add_mixes(Chain& chain, const NetworkWeights& weights,
                                              const Windows& beauty, std::span<const std::string> names,
                                              std::span<const Light> lights) const {
  std::array<std::optional<ImageId>, kLightsAtOnce> coarse;
  for (std::size_t i = kScales; i-- > 0;) {
    const bool is_finest = i == 0;
    auto pass = chain.pass("smooth/mix");
    pass.read("features", features_[i])
        .read("weights", window_weights_[i])
        .read("irradiance_confidence", beauty.irradiance_confidence[i], gpu::reach(kWindowRadius))
        .read("affinities", beauty.affinities[i], gpu::reach(kWindowRadius))
        .read("own_irradiance_confidence",
              is_finest ? std::optional(beauty.own_irradiance_confidence) : std::nullopt, gpu::reach(1));
    for (std::size_t l = 0; l < kLightsAtOnce; ++l) {
      std::optional<ImageId> light, own, result;
      if (l < lights.size()) light = lights[l].irradiance[i];
      if (l < lights.size() && is_finest) own = lights[l].own;
      if (l < names.size())
        result = chain.image(fmt::format("{}.windows.L{}", names[l], i), Format::f32x4, extent(i));
      pass.read(fmt::format("light{}", l), light, gpu::reach(kWindowRadius))
          .read(fmt::format("own_light{}", l), own, gpu::reach(1))
          .read(fmt::format("coarse{}", l), coarse[l], gpu::coarser(2, 1))
          .write(fmt::format("result{}", l), result);
      coarse[l] = result;
    }
    pass.specialize("planes", weights.channels[i] / kPlane)
        .specialize("framed", framed_)
        .specialize("has_coarse", i + 1 < kScales ? 1 : 0)
        .specialize("has_own", is_finest ? 1 : 0)
        .specialize("lights", static_cast<int>(lights.size()))
        .specialize("strip", strip(chain, extent(i)))
        .dispatch({extent(i).width, ceil_div(extent(i).height, strip(chain, extent(i)))});
  }
  std::vector<ImageId> results;
  for (std::size_t l = 0; l < names.size(); ++l) results.push_back(*coarse[l]);
  return results;
}

NetworkPasses::Windows NetworkPasses::add_windows(Chain& chain, const NetworkWeights& weights,
                                                  const NoisyInputs& frame, const Layered& irradiance,
                                                  ImageId smoothed, ImageId stats, bool has_lights) const {
  Windows windows;
  windows.own_irradiance_confidence = chain.image("beauty.own_irradiance_confidence", Format::f32x4, padded_);
  for (std::size_t i = 0; i < kScales; ++i) {
    windows.irradiance_confidence[i] =
        chain.image(fmt::format("beauty.irradiance_confidence.L{}", i), Format::f32x4, extent(i));
    windows.affinities[i] = chain.image(fmt::format("beauty.affinities.L{}", i), Format::f32x4, extent(i));
    auto pass = chain.pass(i == 0 ? "smooth/confidence" : "smooth/reduce");
    if (i == 0) {
      pass.read("irradiance", irradiance.merged)
          .read("own_irradiance", irradiance.own)
          .write("own_irradiance_confidence", windows.own_irradiance_confidence);
    } else {
      pass.read("finer", windows.irradiance_confidence[i - 1], gpu::block(2));
    }
    pass.read("features", features_[i])
        .read("weights", confidence_weights_[i])
        .write("irradiance_confidence", windows.irradiance_confidence[i])
        .write("affinities", windows.affinities[i])
        .specialize("planes", weights.channels[i] / kPlane)
        .specialize("framed", framed_)
        .dispatch(extent(i));
  }
  const std::string name = "beauty";
  const ImageId mean = add_mixes(chain, weights, windows, {&name, 1}, {}).front();
  std::optional<ImageId> divisor;
  if (has_lights) divisor = windows.divisor = chain.image("windows.divisor", Format::f32x4, full_);
  const gpu::Footprint window = gpu::reach(frame.has_albedo ? kWindowRadius : 0);
  chain.pass("smooth/finish")
      .read("features", features_[0])
      .read("weights", finish_weights_)
      .read("affinities", windows.affinities[0], window)
      .read("irradiance", mean)
      .read("color", frame.color)
      .read("variance", frame.variance)
      .read("albedo_depth", frame.features->albedo_depth, window)
      .read("own_albedo_depth", frame.own_features->albedo_depth, window)
      .read("exposure", frame.exposure)
      .write("smoothed", smoothed)
      .write("stats", stats)
      .write("divisor", divisor)
      .specialize("planes", weights.channels[0] / kPlane)
      .specialize("framed", framed_)
      .specialize("albedos", !frame.has_albedo                      ? 0
                             : frame.own_features == frame.features ? 1
                                                                    : 2)
      .specialize("has_lights", has_lights ? 1 : 0)
      .specialize("strip", strip(chain, full_))
      .dispatch({full_.width, ceil_div(full_.height, strip(chain, full_))});
  return windows;
}

std::vector<ImageId> NetworkPasses::add_light_windows(Chain& chain, const NetworkWeights& weights,
                                                      const NoisyInputs& frame,
                                                      std::span<const std::string> names,
                                                      std::span<const Layered> lights,
                                                      const Windows& beauty) const {
  std::vector<Light> irradiance(lights.size());
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const Layered finest = add_demodulate(chain, frame, names[l], lights[l], /*wants_grey=*/false).irradiance;
    Scales& scales = irradiance[l].irradiance;
    irradiance[l].own = finest.own;
    scales[0] = finest.merged;
    for (std::size_t i = 1; i < kScales; ++i) {
      scales[i] = chain.image(fmt::format("{}.irradiance.L{}", names[l], i), Format::f32x4, extent(i));
      chain.pass("smooth/reduce_light")
          .read("finer", scales[i - 1], gpu::block(2))
          .read("irradiance_confidence", beauty.irradiance_confidence[i - 1], gpu::block(2))
          .write("light", scales[i])
          .dispatch(extent(i));
    }
  }
  const std::vector<ImageId> means = add_mixes(chain, weights, beauty, names, irradiance);
  std::vector<ImageId> smoothed;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    smoothed.push_back(chain.image("windows." + names[l], Format::f32x4, full_));
    chain.pass("smooth/finish_light")
        .read("irradiance", means[l])
        .read("divisor", beauty.divisor)
        .read("color", lights[l].merged)
        .read("variance", frame.variance)
        .read("exposure", frame.exposure)
        .write("smoothed", smoothed.back())
        .dispatch(full_);
  }
  return smoothed;
}

}  // namespace becalm::filter
