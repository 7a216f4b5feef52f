#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>

#include "filter/gpu/chain.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

/// Parameters that host passes read when they run.
class HostWeights {
 public:
  explicit HostWeights(const NetworkWeights& network) : network_(network) {}

  /// Takes effect with the next run.
  void replace(const NetworkWeights& network) {
    network_ = network;
    ++version_;
  }
  const NetworkWeights& network() const { return network_; }
  int version() const { return version_; }

 private:
  NetworkWeights network_;
  int version_ = 0;
};

/// One of a network's layers.
using LayerOf = std::function<const Layer&(const NetworkWeights&)>;
LayerOf encoder(std::size_t scale);
LayerOf decoder(std::size_t scale);
LayerOf finisher();

/// Declares the host passes that compute the network's features of every scale by oneDNN, on devices that are
/// processors. On other devices shaders/smooth/convolve*.comp and pool.comp compute them. `inputs` has the
/// size `size`, a multiple of 2^(kScales - 1). The features are framed (shaders/lib/head.glsl).
std::array<gpu::ImageId, kScales> add_host_features(gpu::Chain& chain,
                                                    const std::array<int, kScales>& channels,
                                                    const std::shared_ptr<const HostWeights>& weights,
                                                    gpu::Extent size, gpu::ImageId inputs);

}  // namespace becalm::filter
