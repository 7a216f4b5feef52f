#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"
#include "filter/input/surface_images.h"
#include "filter/smooth/host_features.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

struct Smoothed {
  gpu::ImageId color;                  ///< f32x4
  gpu::ImageId stats;                  ///< f32x2: (remaining variance; 1, or 0 for a non-finite pixel)
  std::vector<gpu::ImageId> additive;  ///< f32x4
};

/// Radiance (f32x4) to smooth: of a merged frame and of the unmerged one. For a single frame both are the
/// same.
struct Layered {
  gpu::ImageId merged;
  gpu::ImageId own;
};

/// The trained parameters that the passes use.
struct Weights {
  const NetworkWeights& network;
  const OwnShareWeights* own_share;  ///< null: an albedo is smoothed, and nothing of the frame is put back
};

/// What computes the network's features: the kernels of shaders/smooth/, or oneDNN if the device is a
/// processor.
enum class Convolver { kernels, host };
constexpr Convolver convolver_of(const gpu::DeviceInfo& device) {
  return device.is_processor ? Convolver::host : Convolver::kernels;
}

/// Additive AOVs that one pass averages; as many as shaders/smooth/mix.comp has images for.
constexpr int kLightsAtOnce = 3;

/// The passes that smooth a frame by a network. From the frame and its features the network predicts the
/// weights of a window around each pixel of five scales. The windows average the radiance, from the coarsest
/// scale to the finest. Weights are positive and sum to 1. A merged frame's result is then mixed with the
/// frame itself (filter/smooth/own_share.h).
class NetworkPasses {
 public:
  /// Declares the passes. Additive AOVs are averaged by the beauty's windows. `strip`: rows of pixels that
  /// one invocation of the windows' kernels makes, which changes no result; by default as device and image
  /// ask for.
  NetworkPasses(gpu::Chain& chain, const Weights& weights, gpu::Extent full, const NoisyInputs& frame,
                bool variance_known, const std::vector<Layered>& additive, Convolver convolver,
                std::optional<int> strip = std::nullopt);
  /// Uploads weights of the same shape, for the runs that follow; call it once at least, after the chain is
  /// built.
  void upload_weights(gpu::Chain& chain, const NetworkWeights& trained) const;

  const Smoothed& smoothed() const { return smoothed_; }

 private:
  using Scales = std::array<gpu::ImageId, kScales>;
  /// Features of the next coarser scale.
  struct CoarseFeatures {
    gpu::ImageId features;
    int channels;
  };
  using Coarse = std::optional<CoarseFeatures>;

  gpu::Extent extent(std::size_t scale) const;
  /// The weights as the passes read them: of_single_frame() unless the frame is merged.
  NetworkWeights used(const NetworkWeights& network) const;
  using Pack = std::function<std::vector<float>(const NetworkWeights&)>;
  struct PackedWeights {
    gpu::ImageId image;
    Pack pack;
  };
  gpu::ImageId weights_image(gpu::Chain& chain, const std::string& name, const NetworkWeights& weights,
                             Pack pack);
  struct Demodulated {
    Layered irradiance;  ///< f32x4
    Layered grey;        ///< f32, if wanted
  };
  /// For the frame or an additive AOV.
  Demodulated add_demodulate(gpu::Chain& chain, const NoisyInputs& frame, const std::string& name,
                             const Layered& radiance, bool wants_grey) const;
  gpu::ImageId add_inputs(gpu::Chain& chain, const NoisyInputs& frame, const Demodulated& demodulated,
                          bool variance_known) const;
  gpu::ImageId add_convolution(gpu::Chain& chain, const std::string& name, const NetworkWeights& weights,
                               const LayerOf& layer_of, std::size_t scale, gpu::ImageId source,
                               const Coarse& coarse);
  Scales add_features(gpu::Chain& chain, const NetworkWeights& weights, gpu::ImageId inputs);
  /// What the beauty's windows leave for those of additive AOVs.
  struct Windows {
    Scales irradiance_confidence;
    gpu::ImageId own_irradiance_confidence;
    Scales affinities;
    gpu::ImageId divisor;  ///< f32x4: what the irradiance is multiplied by
  };
  /// Writes the smoothed frame and its statistics. `has_lights`: add_light_windows() will need the result.
  Windows add_windows(gpu::Chain& chain, const NetworkWeights& weights, const NoisyInputs& frame,
                      const Layered& irradiance, gpu::ImageId smoothed, gpu::ImageId stats,
                      bool has_lights) const;
  /// Averages at most kLightsAtOnce additive AOVs by the beauty's windows; `names` has one entry for each.
  std::vector<gpu::ImageId> add_light_windows(gpu::Chain& chain, const NetworkWeights& weights,
                                              const NoisyInputs& frame, std::span<const std::string> names,
                                              std::span<const Layered> lights, const Windows& beauty) const;
  /// An additive AOV without albedo.
  struct Light {
    Scales irradiance;
    gpu::ImageId own;  ///< of the unmerged frame, at the finest scale
  };
  /// The windows' means at the finest scale: of the lights or, if there are none, of the beauty. `names` has
  /// one entry for each of them.
  std::vector<gpu::ImageId> add_mixes(gpu::Chain& chain, const NetworkWeights& weights, const Windows& beauty,
                                      std::span<const std::string> names,
                                      std::span<const Light> lights) const;
  int strip(const gpu::Chain& chain, gpu::Extent extent) const;

  gpu::Extent full_;
  gpu::Extent padded_;
  std::optional<int> strip_;
  bool merged_;
  int framed_;  ///< features are as add_host_features() makes them
  std::vector<PackedWeights> weights_;
  std::shared_ptr<HostWeights> host_weights_;
  Scales features_;
  Scales confidence_weights_;
  Scales window_weights_;
  gpu::ImageId finish_weights_;
  Smoothed smoothed_;
};

/// Side of the coarsest scale's pixel.
constexpr int kNetworkGridPx = 1 << (kScales - 1);

}  // namespace becalm::filter
