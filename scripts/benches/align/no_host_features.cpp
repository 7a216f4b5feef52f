// Replaces filter/smooth/host_features.cpp in bench_align, which uses no network and must run on machines
// without oneDNN and oneTBB.

#include "filter/smooth/host_features.h"

namespace becalm::filter {

std::array<gpu::ImageId, kScales> add_host_features(gpu::Chain&, const NetworkWeights&, gpu::Extent,
                                                    gpu::ImageId) {
  throw gpu::DeviceError("bench_align has no network");
}

}  // namespace becalm::filter
